tool Cutter {
    units mm;
    profile {
        start (0, 0);
        line to (3, 0), (3, 20) as flute cutting;
        line to (3, 50), (0, 50) as shank;
    }
}
