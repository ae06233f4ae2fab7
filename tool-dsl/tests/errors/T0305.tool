tool Pin {
    units mm;
    profile {
        start (0, 0);
        arc to (3, 3) center (0, 3.02) as ball;
        line to (3, 20), (0, 20) as side;
    }
}
