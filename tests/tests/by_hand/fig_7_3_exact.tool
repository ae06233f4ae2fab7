// The solid of fig. 7.3 with Euclidean distances: the splits lie where the nearest feature changes.
tool Fig73Exact "ball end mill, spindle and housing, exact distances (after Ho 1999, fig. 7.3)" {
    units mm;
    tip z = 20;
    spindle -z;

    curve back = z + d - 5;
    curve shoulder = z - d - 6;
    curve parabola = 4mm*(d - 4) + (z - 11)^2; // as far from d = 5 as from (3, 11)
    curve bevel = z - 16 + 3*sqrt(2) - (sqrt(2) - 1)*d; // as far from d = 3 as from the taper
    curve taper = z + d - 16;
    curve corner = z - d - 14; // square to the taper, through (1, 15)
    curve ball = hypot(d, z - 19) - 1;

    region I as housing where z >= 0, back <= 0 {
        depth: z;
        direction: (0, -1);
    }
    region II as housing
        where d <= 5, z <= 11, back >= 0, min(shoulder, d - 3) <= 0, parabola >= 0
    {
        depth: 5 - d;
        direction: (1, 0);
    }
    region III as housing where d >= 3, shoulder >= 0, z <= 11 {
        depth: 11 - z;
        direction: (0, 1);
    }
    region IV as housing where d <= 3, z <= 11, parabola <= 0 {
        depth: hypot(d - 3, z - 11);
        direction: toward (3, 11);
    }
    region V as spindle where d <= 3, z >= 11, bevel <= 0 {
        depth: 3 - d;
        direction: (1, 0);
    }
    region VI as spindle where taper <= 0, bevel >= 0, corner <= 0 {
        depth: -taper/sqrt(2);
        direction: (1, 1);
    }
    region VII as spindle where corner >= 0, z <= 15 {
        depth: hypot(d - 1, z - 15);
        direction: toward (1, 15);
    }
    region VIII as flute cutting where d <= 1, 15 <= z <= 19 {
        depth: 1 - d;
        direction: (1, 0);
        niceness: 2*d^2;
    }
    region IX as nose cutting where z >= 19, ball <= 0 {
        depth: -ball;
        direction: away from (0, 19);
        niceness: 2*d^2 + (z - 19)^2;
    }
}
