tool Ball {
    units mm;
    region ball where hypot(d, z - 3) <= 3 { depth: 3 - hypot(d, z - 3); magnitude: 5; }
}
