tool ThreadMill "thread mill of five teeth, 7.8 mm, pitch 1.5 for M10, 8 mm shank, 63 long" {
    units mm;
    let pitch = 1.5;
    let crest = 3.9;
    let root = 3;
    let flank = (crest - root)*tan(30deg);
    let land = pitch/8;
    let tooth = 2*flank + land;

    profile {
        start (0, 0);
        line to (root, 0) as face;
        line to (crest, flank), (crest, flank + land), (root, tooth) as tooth cutting;
        line to (root, pitch) as groove;
        line to (crest, pitch + flank), (crest, pitch + flank + land), (root, pitch + tooth)
            as tooth cutting;
        line to (root, 2*pitch) as groove;
        line to (crest, 2*pitch + flank), (crest, 2*pitch + flank + land), (root, 2*pitch + tooth)
            as tooth cutting;
        line to (root, 3*pitch) as groove;
        line to (crest, 3*pitch + flank), (crest, 3*pitch + flank + land), (root, 3*pitch + tooth)
            as tooth cutting;
        line to (root, 4*pitch) as groove;
        line to (crest, 4*pitch + flank), (crest, 4*pitch + flank + land), (root, 4*pitch + tooth)
            as tooth cutting;
        line to (root, 24) as neck;
        line to (4, 25), (4, 63), (0, 63) as shank;
    }
    niceness tooth: 1 - depth;
}
