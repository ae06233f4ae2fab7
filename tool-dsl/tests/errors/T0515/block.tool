solid Block {
    units mm;
    region b where hypot(x, y, z) <= 3 { depth: 3 - hypot(x, y, z); }
}
