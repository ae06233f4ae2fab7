tool Drill "twist drill, 8.5 mm, 118 degrees, flute 75, 117 long (DIN 338)" {
    units mm;
    param D = 8.5;
    param flute = 75;
    param length = 117;
    let r = D/2;

    profile {
        start (0, 0);
        line to (r, r/tan(59deg)) as point cutting;
        line to (r, flute) as flute;
        line to (r, length), (0, length) as shank;
    }
}
