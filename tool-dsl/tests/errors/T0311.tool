tool Pin {
    units mm;
    profile {
        start (0, 0);
        line to (0, 2), (3, 2), (3, 20), (0, 20) as side;
    }
}
