tool Pin {
    units mm;
    profile {
        start (1, 0);
        line to (3, 0), (3, 20), (0, 20) as side;
    }
}
