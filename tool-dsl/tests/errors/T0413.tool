tool Ball {
    units mm;
    region ball where hypot(d, z - 3) <= 3 { magnitude: 30deg; }
}
