tool Neck "a face, then a concave arc to a stem" {
    units mm;
    profile {
        start (0, 0);
        line to (5, 0), (5, 1)                as face;
        arc  to (3, 5) center (8, 5) concave  as neck;
        line to (3, 9), (0, 9)                as stem;
    }
}
