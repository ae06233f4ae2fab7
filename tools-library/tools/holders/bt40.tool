tool Bt40 "BT40 collet chuck without its nut, as far as the spindle's face" {
    units mm;

    profile {
        start (0, 0);
        line to (14, 0), (14, 20), (20, 43) as body;
        arc to (22, 45) radius 2 concave as body;
        line to (31.5, 45), (31.5, 51) as flange;
        line to (26.5, 54), (26.5, 56), (31.5, 59) as groove;
        line to (31.5, 72), (0, 72) as flange;
    }
}
