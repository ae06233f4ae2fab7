tool Er16 "ER16 clamping nut" {
    units mm;

    profile {
        start (0, 0);
        line to (12.9, 0), (14, 1.1), (14, 17.5), (0, 17.5) as nut;
    }
}
