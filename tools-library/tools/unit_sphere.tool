tool UnitSphere "unit sphere (Ho 1999, eq. 4.1, 4.2)" {
    units mm;
    tip z = -1;

    curve ball = hypot(d, z) - 1;

    region ball where ball <= 0 {
        depth: -ball;
        direction: away from (0, 0);
    }
}
