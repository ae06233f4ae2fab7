tool D2Ball "2 mm ball end mill, flute to 5, straight shank to 40" {
    units mm;
    let r = 2/2;

    profile {
        start (0, 0);
        arc to (r, r) center (0, r) as ball cutting;
        line to (r, 5) as flute cutting;
        line to (r, 40), (0, 40) as shank;
    }
    niceness cutting: 1 - depth/r;
}
