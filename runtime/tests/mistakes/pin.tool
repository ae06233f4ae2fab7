tool Pin {
    units mm;
    param D = 2;
    param long = 10;
    profile { start (0, 0); line to (D/2, 0), (D/2, long), (0, long) as pin; }
}
