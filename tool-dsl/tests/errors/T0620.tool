tool Ball {
    units mm;
    curve r = hypot(d, z - 3);
    region core where r <= 1 { depth: 2*(3 - r); }
    region shell where 1 <= r <= 3 { depth: 3 - r; }
}
