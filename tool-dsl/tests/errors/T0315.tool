tool Pin {
    units mm;
    profile {
        start (0, 0);
        arc to (3, 3) radius 3 concave as side;
        line to (3, 5), (0, 5) as top;
    }
}
