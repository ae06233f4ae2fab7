tool OffTip {
    units mm;
    profile { start (0, 3); line to (2, 3), (2, 5), (0, 5) as body; }
}
