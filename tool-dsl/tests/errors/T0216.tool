tool Ball {
    let r = 3;
    units mm;
    region ball where hypot(d, z - r) <= 3 { depth: 3 - hypot(d, z - r); }
}
