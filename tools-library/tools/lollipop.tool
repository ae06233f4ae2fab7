tool Lollipop "undercutting ball, 10 mm on a 6 mm neck, 10 mm shank, 75 long" {
    units mm;
    let r = 10/2;

    profile {
        start (0, 0);
        arc to (r, r) center (0, r) as ball cutting;
        arc to (3, 9) center (0, r) as ball cutting;
        line to (3, 40) as neck;
        line to (5, 43), (5, 75), (0, 75) as shank;
    }
    niceness ball: 1 - depth/r;
}
