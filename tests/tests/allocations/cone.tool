tool Cone {
    units mm;

    profile {
        start (0, 0);
        line to (60, 60) as flank cutting;
        line to (0, 60) as back;
    }
    niceness cutting: 1;
}
