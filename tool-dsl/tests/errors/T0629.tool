tool Ball {
    units mm;
    region ball where hypot(d, z - 3) <= 3 { depth: 3 - hypot(d, z - 3); direction: (0, -1) allow oblique; }
}
