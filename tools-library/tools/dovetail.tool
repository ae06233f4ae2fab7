tool Dovetail "dovetail cutter, 20 mm, 60 degrees, 6.3 high, 12 mm shank, 63 long" {
    units mm;
    let R = 20/2;
    let high = 6.3;

    profile {
        start (0, 0);
        line to (R, 0) as face cutting;
        line to (R - high/tan(60deg), high) as flank cutting;
        line to (5, high), (5, 25) as neck;
        line to (6, 25), (6, 63), (0, 63) as shank;
    }
    niceness face: 0.5;
    niceness flank: 1 - depth/2;
}
