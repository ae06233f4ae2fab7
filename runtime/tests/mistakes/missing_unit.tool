tool Ball {
    let r = 3;
    curve nose = hypot(d, z - r) - r;
    region ball where nose <= 0 { depth: -nose; }
}
