tool SpotDrill "spot drill, 8 mm, 90 degrees, flute 25, 79 long" {
    units mm;
    let r = 8/2;

    profile {
        start (0, 0);
        line to (r, r) as point cutting;
        line to (r, 25) as flute;
        line to (r, 79), (0, 79) as shank;
    }
    niceness point: 1 - depth/r;
}
