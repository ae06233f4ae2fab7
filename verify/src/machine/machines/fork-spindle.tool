tool ForkSpindle "spindle of a fork head, 200 mm wide, from its gauge point" {
    units mm;

    profile {
        start (0, 0);
        line to (45, 0), (45, 25), (60, 30), (60, 60) as nose;
        line to (100, 90), (100, 330), (0, 330) as housing;
    }
}
