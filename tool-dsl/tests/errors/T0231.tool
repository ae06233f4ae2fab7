tool Ball {
    units mm;
    region ball where sin(d) <= 0.5 { depth: 3 - d; }
}
