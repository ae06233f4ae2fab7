tool Ball {
    units mm;
    region ball where d² + (z - 3)^2 <= 9 { depth: 3 - hypot(d, z - 3); }
}
