// The functions of the thesis as it states them. IV, VI and VII are not distances.
tool Fig73 "ball end mill, spindle and housing (Ho 1999, fig. 7.3, eq. 7.1-7.3)" {
    units mm;
    tip z = 20;
    spindle -z;

    curve back = z + d - 5;
    curve shoulder = z - d - 6;
    curve corner = z + d - 14; // V | VII
    curve cone = z + d - 16; // the taper itself, and VII | VIII
    curve ball = hypot(d, z - 19) - 1;

    region I as housing where z >= 0, back <= 0 {
        magnitude: z;
        direction: (0, -1);
    }
    region II as housing where d <= 5, back >= 0, z <= max(9, d + 6) {
        magnitude: 5 - d;
        direction: (1, 0);
    }
    region III as housing where d >= 3, shoulder >= 0, z <= 11 {
        magnitude: 11 - z;
        direction: (0, 1);
    }
    region IV as housing where d <= 3, 9 <= z <= 11 {
        magnitude: 14 - d - z;
        direction: (1, 1); // the thesis's; toward (3, 11) would be the exact one
    }
    region V as spindle where d <= 3, 11 <= z <= max(13, 14 - d) {
        magnitude: 3 - d;
        direction: (1, 0);
    }
    region VI as spindle where d >= 1, z >= 13, cone <= 0 {
        magnitude: 16 - d - z;
        direction: (1, 1);
    }
    region VII as spindle where d <= 1, corner >= 0, cone <= 0 {
        magnitude: 17 - 2*d - z;
        direction: (2, 1);
    }
    region VIII as flute cutting where d <= 1, cone >= 0, z <= 19 {
        magnitude: 1 - d;
        direction: (1, 0);
        niceness: 2*d^2;
    }
    region IX as nose cutting where z >= 19, ball <= 0 {
        magnitude: -ball;
        direction: away from (0, 19);
        niceness: 2*d^2 + (z - 19)^2;
    }
}
