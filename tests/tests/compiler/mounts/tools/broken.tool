tool Broken {
    units mm;
    profile {
        start (0, 0);
        line to (length, 0), (1, 5), (0, 5) as body;
    }
}
