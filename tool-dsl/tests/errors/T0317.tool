tool Pin {
    units mm;
    profile {
        start (0, 0);
        line to (3, 0), (3, 5), (3.0000000005, 9), (0, 9) as side;
    }
}
