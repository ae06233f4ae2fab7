tool FaceMill "face mill, 50 mm, 45 degrees, on a 22 mm arbor" {
    units mm;

    profile {
        start (0, 3);
        line to (17, 3), (19, 0) as body; // hollow below
        line to (25, 0) as face cutting;
        line to (31, 6) as edge cutting;
        line to (24, 13), (20, 20), (20, 40), (0, 40) as body;
    }
    niceness edge: 1 - depth/6;
    niceness face: 0.5;
}
