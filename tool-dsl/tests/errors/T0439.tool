tool Pin {
    units mm;
    profile {
        start (0, 0);
        line to (3, 0) as face;
        line to (3, 20) as flute;
        line to (0, 20) as top;
    }
    niceness cutting: 1 - depth/3;
}
