tool Pin {
    units mm;
    profile {
        start (0, 1);
        line to (3, 1), (3, 20), (0, 20) as side;
    }
}
