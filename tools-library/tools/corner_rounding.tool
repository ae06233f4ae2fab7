tool CornerRounding "corner rounding cutter, r 3, pilot 6 mm, head 13 mm, 12 mm shank, 60 long" {
    units mm;
    let r = 3;

    profile {
        start (0, 0);
        line to (3, 0) as face;
        line to (3, 0.5) as pilot cutting;
        arc to (6, 3.5) radius r concave as fillet cutting;
        line to (6.5, 3.5) as rim cutting;
        line to (6.5, 10) as head;
        line to (6, 10.5), (6, 60), (0, 60) as shank;
    }
    niceness fillet: 1 - depth/r;
    niceness pilot: 0.2;
    niceness rim: 0.2;
}
