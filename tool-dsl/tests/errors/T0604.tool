tool Ball {
    units mm;
    region ball where d <= 3, z >= 0 { depth: min(3 - d, z); }
}
