tool BoringBar "boring bar turning, 32 mm, insert r 0.4, 25 mm bar, 150 long" {
    units mm;
    let R = 32/2;
    let r = 0.4;

    profile {
        start (0, 0.6);
        line to (14, 0.6), (R - r, 0) as front;
        arc to (R, r) center (R - r, r) as nose cutting;
        line to (15, 9) as relief;
        line to (12.5, 9), (12.5, 150), (0, 150) as bar;
    }
    niceness nose: 1 - depth/r;
}
