tool Ball {
    units mm;
    region ball where hypot(d, z - 3) <= 3 { depth: 3 - hypot(d, z - 3); direction: (1, 0); direction: (0, -1); }
}
