tool BullNose "bull nose end mill, 12 mm, 2 mm corners, neck 11.2 to 40, 83 long" {
    units mm;
    param D = 12;
    param r = 2; // the corners'
    param length = 83;
    let R = D/2;

    profile {
        start (0, 0);
        line to (R - r, 0) as face cutting;
        arc to (R, r) center (R - r, r) as corner cutting;
        line to (R, 14) as flute cutting;
        line to (R - 0.4, 14.4), (R - 0.4, 40) as neck;
        line to (R, 40.4), (R, length), (0, length) as shank;
    }
    niceness cutting: 1 - depth/r;
}
