tool Ball {
    units mm;
    let d = 6;
    region ball where hypot(d, z - 3) <= 3 { depth: 3 - hypot(d, z - 3); }
}
