tool Ball {
    units mm;
    region a where hypot(d, z - 3) <= 3 { depth: 3 - hypot(d, z - 3); }
    region b where hypot(d, z - 4) <= 3 { depth: 3 - hypot(d, z - 4); }
}
