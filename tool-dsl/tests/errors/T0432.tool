solid Ball {
    units mm;
    tip z = 3;
    region b where hypot(x, y, z) <= 3 { depth: 3 - hypot(x, y, z); }
}
