tool Ball {
    units mm;
    region ball where max(d, z^2) <= 3 { depth: 3 - d; }
}
