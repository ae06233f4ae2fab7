tool Regions {
    units mm;
    region ball where hypot(d, z - 1) <= 1 { depth: 1 - hypot(d, z - 1); }
}
