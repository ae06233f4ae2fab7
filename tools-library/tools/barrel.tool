tool Barrel "barrel cutter, 10 mm, flank R 85, 1 mm corner, 80 long" {
    units mm;
    let R = 85;
    let r = 1;
    let axis = 5 - R; // the flank's centre
    let waist = 8;
    // The corner touches the flank from inside, and the plane z = 0.
    let low = waist - r;
    let inner = axis + sqrt((R - r)^2 - low^2);
    let touch = axis + (inner - axis)*R/(R - r);

    profile {
        start (0, 0);
        line to (inner, 0) as face cutting;
        arc to (touch, waist - low*R/(R - r)) center (inner, r) as corner cutting;
        arc to (axis + sqrt(R^2 - 7^2), waist + 7) center (axis, waist) as flank cutting;
        line to (4, 16), (4, 45) as neck;
        line to (5, 46), (5, 80), (0, 80) as shank;
    }
    niceness cutting: 1 - depth/r;
}
