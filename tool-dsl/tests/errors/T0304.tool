tool Pin {
    units mm;
    profile {
        start (0, 0);
        line to (3, 0), (3, 0), (3, 20), (0, 20) as side;
    }
}
