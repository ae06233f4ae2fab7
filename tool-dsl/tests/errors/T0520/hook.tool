tool Part {
    units mm;
    profile {
        start (0, 0);
        line to (3, 0), (3, 5), (5, 5), (5, 3), (8, 3), (8, 20), (0, 20) as side;
    }
}
