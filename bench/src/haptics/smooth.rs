//! The tool of Ho 1999, fig. 7.3, with directions that do not jump at corners.

touchoff::tool! {
    tool Fig73Smooth "ball end mill, spindle and housing, directions that turn in fans (after Ho 1999, fig. 7.3)" {
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
        regions smooth 0.5;
        niceness flute: 2*d^2;
        niceness nose: 2*d^2 + (z - 19)^2;
    }
}
