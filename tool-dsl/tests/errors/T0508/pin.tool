tool Part {
    units mm;
    profile {
        start (0, 0);
        line to (3, 0) as face cutting;
        line to (3, 20) as side cutting;
        line to (0, 20) as top;
    }
}
