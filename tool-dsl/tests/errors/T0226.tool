tool Ball {
    units mm;
    let a = 30deg^2;
    region ball where hypot(d, z - 3) <= 3 { depth: 3 - hypot(d, z - 3); }
}
