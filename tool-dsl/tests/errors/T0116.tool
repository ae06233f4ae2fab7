tool Ball {
    units mm;
    region ball where hypot(d, z - 3) <= 3 { deepness: 3 - d; }
}
