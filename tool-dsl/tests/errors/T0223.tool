tool Ball {
    units mm;
    region ball where hypot(d, z - 3) + d^2 <= 3 { depth: 3 - hypot(d, z - 3); }
}
