tool Ball {
    units mm;
    let s = sin(1e9rad);
    region ball where hypot(d, z - 3) <= 3 { depth: 3 - hypot(d, z - 3); }
}
