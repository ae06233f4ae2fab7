tool Reamer "machine reamer, 8 mm H7, lead 1 mm, 33 of flute, 117 long (DIN 212)" {
    units mm;

    profile {
        start (0, 0);
        line to (3, 0) as face;
        line to (4, 1) as lead cutting;
        line to (4, 33) as land cutting;
        line to (3.6, 34), (3.6, 75) as neck;
        line to (4, 76), (4, 117), (0, 117) as shank;
    }
    niceness lead: 1 - depth/0.2;
    niceness land: 1 - depth/0.05;
}
