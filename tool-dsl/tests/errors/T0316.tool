tool Pin {
    units mm;
    profile {
        start (0, 0);
        line to (3, 0), (5, 0), (4, 0), (4, 5), (0, 5) as side;
    }
}
