tool SingleTooth "thread mill of one tooth, 5.9 mm, up to pitch 1.25, 6 mm shank, 58 long" {
    units mm;
    let flank = 0.9*tan(30deg);

    profile {
        start (0, 0);
        line to (2.05, 0) as face;
        line to (2.95, flank), (2.95, flank + 0.1), (2.05, 2*flank + 0.1) as tooth cutting;
        line to (2.05, 20) as neck;
        line to (3, 21), (3, 58), (0, 58) as shank;
    }
    niceness tooth: 1 - depth;
}
