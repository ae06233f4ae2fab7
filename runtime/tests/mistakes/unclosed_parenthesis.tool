tool Ball {
    units mm;
    curve nose = hypot(d, (z - 3) - 3;
    region ball where nose <= 0 { depth: -nose; }
}
