tool Pin {
    units mm;
    profile {
        start (0, 0);
        line to (3, 0), (3, 20) as side;
    }
}
