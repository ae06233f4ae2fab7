tool Ball {
    units mm;
    let wide = 2*r;
    let r = wide/2;
    region ball where hypot(d, z - 3) <= 3 { depth: 3 - hypot(d, z - 3); }
}
