tool Hsk63 "HSK-A63 collet chuck without its nut, as far as the spindle's face" {
    units mm;

    profile {
        start (0, 0);
        line to (23, 0), (23, 30), (26.5, 38), (31, 38), (31.5, 38.5) as body;
        line to (31.5, 45) as flange;
        line to (26.5, 47.9), (26.5, 51.1), (31.5, 54) as groove; // the changer's, 63 / 53 / 63
        line to (31.5, 64), (0, 64) as flange;
    }
}
