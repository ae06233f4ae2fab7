tool TaperedBall "tapered ball end mill, r 1, 3 degrees a side, 6 mm shank, 75 long" {
    units mm;
    param r = 1;
    param slope = 3deg;
    let R = 6/2;
    let touch = r*cos(slope); // where the ball passes into the cone
    let rise = r - r*sin(slope);

    profile {
        start (0, 0);
        arc to (touch, rise) center (0, r) as ball cutting;
        line to (R, rise + (R - touch)/tan(slope)) as cone cutting;
        line to (R, 75), (0, 75) as shank;
    }
    niceness cutting: 1 - depth/r;
}
