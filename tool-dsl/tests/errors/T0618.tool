tool Ball {
    units mm;
    region ball where hypot(d, z - 3) <= 3 { depth: sqrt(9 - d^2 - (z - 3)^2); }
}
