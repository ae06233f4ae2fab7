tool Ball {
    units mm;
    region ball as cutting where hypot(d, z - 3) <= 3 { depth: 3 - hypot(d, z - 3); }
}
