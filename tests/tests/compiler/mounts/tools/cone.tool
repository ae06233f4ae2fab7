tool Cone "a tapered arbor, then a collar" {
    units mm;
    profile {
        start (0, 0);
        line to (2, 0)            as face  cutting;
        line to (8, 12)           as cone  cutting;
        line to (20, 12), (20, 30), (0, 30)  as collar;
    }
    niceness cone: 0.25;
}
