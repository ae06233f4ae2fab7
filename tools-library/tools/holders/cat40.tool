tool Cat40 "CAT40 end mill holder, as far as the spindle's face" {
    units inch;
    let R = 1.75/2;
    let flange = 2.5/2;

    profile {
        start (0, 0);
        line to (R - 0.06, 0), (R, 0.06), (R, 2.25), (flange, 2.25) as body;
        line to (flange, 2.45) as flange;
        line to (1.05, 2.57), (1.05, 2.67), (flange, 2.79) as groove;
        line to (flange, 3), (0, 3) as flange;
    }
}
