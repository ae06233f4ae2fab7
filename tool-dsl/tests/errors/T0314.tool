tool Pin {
    units mm;
    profile {
        start (0, 20);
        line to (3, 20), (3, 0), (0, 0) as side;
    }
}
