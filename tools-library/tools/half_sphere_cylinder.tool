// The thesis draws this solid along x; its x is z here.
tool HalfSphereCylinder "half sphere r 2 joined to a cylinder r 1 (Ho 1999, fig. 2.2, 2.3)" {
    units mm;
    let R = 2;
    let r = 1;
    tip z = -R;

    profile {
        start (0, -R);
        arc to (R, 0) center (0, 0) as ball;
        line to (r, 0) as step;
        line to (r, 6), (0, 6) as stem;
    }
}
