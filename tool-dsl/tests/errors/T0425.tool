tool Pin {
    units mm;
    profile {
        start (0, 0);
        line to (5, 0) as face;
        arc to (5, 4) radius 2.1 concave as groove;
        arc to (5, 8) radius 2.1 concave as groove;
        line to (0, 8) as top;
    }
    regions smooth 3;
}
