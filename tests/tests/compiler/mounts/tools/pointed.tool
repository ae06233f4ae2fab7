tool Pointed {
    units mm;
    profile { start (0, 0); line to (5, 0), (0, 10) as body; }
}
