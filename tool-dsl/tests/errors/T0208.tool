tool Ball {
    units mm;
    region ball where hypot(d, z - 3) <= 3, y <= 2 { depth: 3 - hypot(d, z - 3); }
}
