tool Ball {
    units mm;
    curve nose = hypot(d, z - 2.5) - 2.5;
    region ball where nose <= 0 {
        depth: -nose;
        direction: away from (0, 2,5);
    }
}
