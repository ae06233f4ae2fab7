tool Pin {
    units mm;
    profile {
        start (0, 0);
        line to (4, 0), (1, 5), (4, 5), (1, 1), (0, 9) as side;
    }
}
