tool TSlot "T-slot cutter, 21 x 9, neck 10, 12 mm shank, 74 long (DIN 851)" {
    units mm;

    profile {
        start (0, 0);
        line to (10.5, 0) as face cutting;
        line to (10.5, 9) as flute cutting;
        line to (5, 9) as back cutting;
        line to (5, 27) as neck;
        line to (6, 28), (6, 74), (0, 74) as shank;
    }
    niceness flute: 1 - depth/3;
    niceness face: 0.4;
    niceness back: 0.4;
}
