tool SpindleHead "spindle head of a machining centre, 260 mm wide, from its gauge point" {
    units mm;

    profile {
        start (0, 0);
        line to (45, 0), (45, 25), (64, 32), (64, 70) as nose;
        line to (130, 100), (130, 420), (0, 420) as housing;
    }
}
