tool ChamferMill "chamfer mill, 90 degrees, 10 mm, tip 1 mm flat, 70 long" {
    units mm;

    profile {
        start (0, 0);
        line to (0.5, 0) as tip;
        line to (5, 4.5) as edge cutting;
        line to (5, 14) as flute cutting;
        line to (5, 70), (0, 70) as shank;
    }
    niceness edge: 1 - depth/2;
    niceness flute: 0.2;
}
