tool Ball {
    units mm;
    region ball where hypot(d, z - 3) <= 3 { depth: 3 - hypot(d, z - 3); direction: (max(d - 1, 0), 0) allow oblique; }
}
