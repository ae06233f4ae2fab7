// The solid of fig. 7.3 with Euclidean distances: regions, depths and directions follow from its profile.
tool Fig73Exact "ball end mill, spindle and housing, exact distances (after Ho 1999, fig. 7.3)" {
    units mm;
    tip z = 20;
    spindle -z;

    profile {
        start (0, 0);
        line to (5, 0), (5, 11), (3, 11) as housing;
        line to (3, 13), (1, 15) as spindle;
        line to (1, 19) as flute cutting;
        arc to (0, 20) center (0, 19) as nose cutting;
    }
    niceness flute: 2*d^2; // eq. 7.3
    niceness nose: 2*d^2 + (z - 19)^2;
}
