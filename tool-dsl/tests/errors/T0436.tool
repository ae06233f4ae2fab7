tool Ball {
    units mm;
    curve low = z - 3;
    bsp { low, low }
    region nose where hypot(d, z - 3) <= 3, low <= 0 { depth: 3 - hypot(d, z - 3); }
    region top where hypot(d, z - 3) <= 3, low >= 0 { depth: 3 - hypot(d, z - 3); }
}
