tool Woodruff "keyseat cutter, 16.5 x 3, filleted neck, 10 mm shank, 56 long" {
    units mm;

    profile {
        start (0, 0);
        line to (8.25, 0) as face cutting;
        line to (8.25, 3) as flute cutting;
        line to (3, 3) as back cutting;
        line to (3, 12) as neck;
        arc to (5, 14) radius 2 concave as neck;
        line to (5, 56), (0, 56) as shank;
    }
    niceness flute: 1 - depth;
    niceness face: 0.3;
    niceness back: 0.3;
}
