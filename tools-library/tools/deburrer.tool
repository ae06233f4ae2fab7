tool Deburrer "deburring cutter for both sides of a hole, 12 mm, 90 degrees, 8 mm shank, 80 long" {
    units mm;

    profile {
        start (0, 0);
        line to (2, 0) as tip;
        line to (6, 4) as front cutting;
        line to (6, 5) as land;
        line to (3, 8) as back cutting;
        line to (3, 40) as neck;
        line to (4, 41), (4, 80), (0, 80) as shank;
    }
    niceness cutting: 1 - depth/2;
}
