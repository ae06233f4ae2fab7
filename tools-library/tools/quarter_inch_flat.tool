tool QuarterInchFlat "1/4 in end mill, corner 0.015 in, flute 3/4 in, 2 1/2 in long" {
    units inch;
    let R = 0.25/2;
    let r = 0.015;

    profile {
        start (0, 0);
        line to (R - r, 0) as face cutting;
        arc to (R, r) center (R - r, r) as corner cutting;
        line to (R, 0.75) as flute cutting;
        line to (R, 2.5), (0, 2.5) as shank;
    }
    niceness flute: 1 - depth/R;
    niceness corner: 0.8;
    niceness face: 0.5;
}
