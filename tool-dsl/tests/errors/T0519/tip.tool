tool Part {
    units mm;
    profile {
        start (0, 0);
        line to (3, 0), (0, 10) as side cutting;
    }
}
