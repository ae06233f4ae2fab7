// Drawn from the face up, with the spindle toward smaller z and the face at z = 2.
tool InchFlat "1/4 in flat end mill" {
    units inch;
    param R = 0.125inch;
    param edge = 0.5;
    tip z = 2;
    spindle -z;
    curve up = 2 - z;

    profile {
        start (0, 0);
        line to (R, 0), (R, 1.25)  as shank;
        line to (R, 2)             as flute cutting;
        line to (0, 2)             as face  cutting;
    }
    magnitude: 7*depth;
    niceness flute: 1 - depth/R + up/8inch;
    niceness face:  edge;
}
