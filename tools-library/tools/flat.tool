tool Flat "square end mill, 12 mm, flute 26, 83 long" {
    units mm;
    param D = 12;
    param flute = 26;
    param length = 83;
    let R = D/2;

    profile {
        start (0, 0);
        line to (R, 0) as face cutting;
        line to (R, flute) as flute cutting;
        line to (R, length), (0, length) as shank;
    }
    niceness flute: 1 - depth/R;
    niceness face: 0.5 - depth/R;
}
