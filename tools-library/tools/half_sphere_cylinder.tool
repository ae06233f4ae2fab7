// The thesis draws this solid along x; its x is z here. Nearest features, written by hand.
tool HalfSphereCylinder "half sphere r 2 joined to a cylinder r 1 (Ho 1999, fig. 2.2, 2.3)" {
    units mm;
    let R = 2;
    let r = 1;
    let h = 6;
    tip z = -R;

    curve ball = R - hypot(d, z);
    curve ledge = hypot(max(r - d, 0), z); // the flat ring at z = 0, its inner edge included
    curve side = r - d;
    curve end = h - z;

    region ball where z <= 0, 0 <= ball <= ledge {
        depth: ball;
        direction: away from (0, 0);
    }
    region step where z <= 0, side <= 0, ledge <= ball {
        depth: -z;
        direction: (0, 1);
    }
    region corner as step where z <= 0, side >= 0, ledge <= ball {
        depth: hypot(d - r, z);
        direction: toward (r, 0);
    }
    region stem where z >= 0, 0 <= side <= end {
        depth: side;
        direction: (1, 0);
    }
    region end as stem where z >= 0, 0 <= end <= side {
        depth: end;
        direction: (0, 1);
    }
}
