tool Pin {
    units mm;
    param chamfer = 0;
    profile {
        start (0, 0);
        line to (3 - chamfer, 0) as face cutting;
        line to (3, chamfer) as chamfer;
        line to (3, 20), (0, 20) as side;
    }
    niceness cutting: 1;
}
