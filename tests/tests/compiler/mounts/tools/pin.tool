tool Pin "a thin pin" {
    units mm;
    param d0 = 2;
    profile {
        start (0, 0);
        line to (d0/2, 0)                 as foot;
        line to (d0/2, 10), (0, 10)       as pin;
    }
}
