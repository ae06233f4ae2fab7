tool Ball {
    units mm;
    let r = sqrt(4 - 9);
    region ball where hypot(d, z - 3) <= 3 { depth: 3 - hypot(d, z - 3); }
}
