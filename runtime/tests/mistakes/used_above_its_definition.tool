tool Ball {
    units mm;
    let r = diameter/2;
    let diameter = 6;
    curve nose = hypot(d, z - r) - r;
    region ball where nose <= 0 { depth: -nose; }
}
