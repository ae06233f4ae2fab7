tool Ball {
    units mm;
    region ball where d <= 3, 0 <= z <= 20 { depth: min(3 - d, z); }
}
