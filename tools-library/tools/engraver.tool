tool Engraver "engraver, 30 degrees, tip 0.1 mm flat, 1/8 inch shank, 38 long" {
    units mm;
    let R = 0.125inch/2;
    let tip = 0.1/2;

    profile {
        start (0, 0);
        line to (tip, 0) as tip cutting;
        line to (R, (R - tip)/tan(15deg)) as edge cutting;
        line to (R, 38), (0, 38) as shank;
    }
    niceness tip: 1;
    niceness edge: 1 - depth/0.2;
}
