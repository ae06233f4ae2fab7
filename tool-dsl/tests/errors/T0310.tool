tool Pin {
    units mm;
    profile {
        start (0, 0);
        line to (3, 0) as face;
        arc to (3, 5) radius 2 as side;
        line to (0, 5) as top;
    }
}
