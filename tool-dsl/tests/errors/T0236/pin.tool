tool Part {
    units mm;
    param D = 6;
    profile {
        start (0, 0);
        line to (D/2, 0) as face cutting;
        line to (D/2, 20) as side cutting;
        line to (0, 20) as top;
    }
}
