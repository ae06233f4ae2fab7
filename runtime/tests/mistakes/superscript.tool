tool Ball {
    units mm;
    curve nose = sqrt(d² + (z - 3)^2) - 3;
    region ball where nose <= 0 { depth: -nose; }
}
