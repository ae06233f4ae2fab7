tool Er32 "ER32 clamping nut" {
    units mm;

    profile {
        start (0, 0);
        line to (20, 0), (22, 3), (25, 3), (25, 22.5), (0, 22.5) as nut;
    }
}
