tool Ball {
    units mm;
    let r = 0.25";
    curve nose = hypot(d, z - r) - r;
    region ball where nose <= 0 { depth: -nose; }
}
