tool Ball {
    units mm;
    let r = ⌀6;
    curve nose = hypot(d, z - 3) - 3;
    region ball where nose <= 0 { depth: -nose; }
}
