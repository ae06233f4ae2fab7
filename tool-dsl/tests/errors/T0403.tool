tool Ball {
    units mm;
    region nose where hypot(d, z - 3) <= 3, z <= 3 { depth: 3 - hypot(d, z - 3); }
    region nose where hypot(d, z - 3) <= 3, z >= 3 { depth: 3 - hypot(d, z - 3); }
}
