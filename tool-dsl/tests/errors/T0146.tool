tool Ball {
    units mm;
    region ball where d <= 3 and 0 <= z <= 40 { depth: 3 - d; }
}
