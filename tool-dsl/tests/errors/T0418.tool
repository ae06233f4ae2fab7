tool Ball {
    units mm;
    region ball as ball cutting where hypot(d, z - 3) <= 3 { depth: 3 - hypot(d, z - 3); }
    niceness ball: 0.5;
    niceness ball: 0.8;
}
