tool Oval "oval cutter, 10 mm, tip r 2 passing into a flank of R 85, 75 long" {
    units mm;
    let r = 2;
    let R = 85;
    let D = 10;
    let back = R - D/2; // the flank's centre lies so far beyond the axis
    let high = sqrt((R - r)^2 - back^2);

    profile {
        start (0, 0);
        arc to (back*R/(R - r) - back, r + high - high*R/(R - r)) center (0, r) as tip cutting;
        arc to (D/2, r + high) center (-back, r + high) as flank cutting;
        line to (D/2, 75), (0, 75) as shank;
    }
    niceness cutting: 1 - depth/r;
}
