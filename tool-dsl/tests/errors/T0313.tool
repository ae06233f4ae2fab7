tool Pin {
    units mm;
    profile {
        start (0, 0);
        line to (3, 0), (0, 4), (3, 8), (0, 8) as side;
    }
}
