tool BallCutter "ball end mill" {
    units mm;
    param D = 6;
    param flute = 20;
    let length = 50;
    let r = D/2;
    profile {
        start (0, 0);
        arc  to (r, r) center (0, r)  as ball  cutting;
        line to (r, flute)            as flute cutting;
        line to (r, length), (0, length)      as shank;
    }
    niceness cutting: 1 - depth/r;
}
