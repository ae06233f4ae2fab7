tool Ball {
    units mm;
    let r = 3
    region ball where hypot(d, z - 3) <= 3 { depth: 3 - hypot(d, z - 3); }
}
