tool Ball {
    units mm;
    region ball where hypot(d, z - 3) <= 3 { direction: (d, z - 3); }
}
