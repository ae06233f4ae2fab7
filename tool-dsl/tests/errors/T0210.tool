tool Ball {
    units mm;
    curve nose = depth - 1;
    region ball where hypot(d, z - 3) <= 3, nose <= 0 { depth: 3 - hypot(d, z - 3); }
}
