tool Ball "ball end mill, 10 mm, flute 22, 72 long" {
    units mm;
    param D = 10;
    param flute = 22;
    param length = 72;
    let r = D/2;

    profile {
        start (0, 0);
        arc to (r, r) center (0, r) as ball cutting;
        line to (r, flute) as flute cutting;
        line to (r, length), (0, length) as shank;
    }
    niceness cutting: 1 - depth/r;
}
