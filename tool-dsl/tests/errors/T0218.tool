tool Ball {
    units mm;
    region ball where hypot(d, z - 3) <= 3, 2d <= 6 { depth: 3 - hypot(d, z - 3); }
}
