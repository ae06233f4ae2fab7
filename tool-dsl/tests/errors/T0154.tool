tool Ball {
    units mm;
    region ball where 0 <= z <= 20 <= 40 { depth: 3 - d; }
}
