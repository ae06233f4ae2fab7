tool Ball {
    units mm;
    region ball where z >= 3, z <= 1, d <= 3 { depth: 3 - d; }
}
