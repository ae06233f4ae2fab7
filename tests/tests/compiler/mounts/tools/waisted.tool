tool Waisted "a groove in its top" {
    units mm;
    profile { start (0, 0); line to (6, 0), (6, 5), (4, 5), (4, 3), (2, 3), (2, 8), (0, 8) as body; }
}
