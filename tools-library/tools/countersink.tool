tool Countersink "countersink, 90 degrees, 16.5 mm, 10 mm shank, 60 long (DIN 335)" {
    units mm;

    profile {
        start (0, 0);
        line to (1.6, 0) as tip;
        line to (8.25, 6.65) as cone cutting;
        line to (8.25, 7.5) as land;
        line to (5, 12), (5, 60), (0, 60) as shank;
    }
    niceness cone: 1 - depth/3;
}
