tool Part {
    units mm;
    param ratio = 2;
    profile {
        start (0, 0);
        line to (ratio, 0) as face cutting;
        line to (ratio, 20) as side cutting;
        line to (0, 20) as top;
    }
}
