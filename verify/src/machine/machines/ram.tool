tool Ram "ram of a gantry, 440 mm wide, from its lower end" {
    units mm;

    profile {
        start (0, 0);
        line to (220, 0), (220, 900), (0, 900) as ram;
    }
}
