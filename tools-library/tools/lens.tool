tool Lens "lens cutter, 12 mm, face R 20, 1 mm corner, 83 long" {
    units mm;
    let R = 20; // the face's
    let r = 1;
    let D = 12;
    let ring = D/2 - r; // the corner's centre
    let rise = sqrt((R - r)^2 - ring^2);

    profile {
        start (0, 0);
        arc to (ring*R/(R - r), R - rise*R/(R - r)) center (0, R) as face cutting;
        arc to (D/2, R - rise) center (ring, R - rise) as corner cutting;
        line to (D/2, 10) as flute cutting;
        line to (5.6, 10.4), (5.6, 40) as neck;
        line to (6, 40.4), (6, 83), (0, 83) as shank;
    }
    niceness cutting: 1 - depth/r;
}
