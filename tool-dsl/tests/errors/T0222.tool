tool Ball {
    units mm;
    tip z = 30deg;
    region ball where hypot(d, z - 3) <= 3 { depth: 3 - hypot(d, z - 3); }
}
