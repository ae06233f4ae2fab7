tool Bulb "a neck, then a ball of radius 5 about z = 9, then a stem" {
    units mm;
    profile {
        start (0, 0);
        line to (3, 0)                            as face;
        line to (3, 5)                            as neck;
        arc  to (5, 9) center (0, 9)              as ball cutting;
        arc  to (3, 13) center (0, 9)             as ball cutting;
        line to (3, 20), (0, 20)                  as stem;
    }
}
