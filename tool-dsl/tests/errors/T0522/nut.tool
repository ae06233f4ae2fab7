tool Nut {
    units mm;
    profile {
        start (0, 0);
        line to (10, 0), (10, 18), (0, 18) as nut;
    }
}
