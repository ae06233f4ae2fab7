tool Pointed {
    units mm;
    profile { start (0, 0); line to (4, 5), (4, 50), (0, 50) as cone; }
}
