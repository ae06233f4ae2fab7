tool Pin {
    units mm;
    profile {
        start (0, 0);
        line to (3, 0) as face cutting;
        line to (3, 20) as side cutting;
        line to (0, 20) as top;
    }
    region low as side cutting where z <= 10 {}
    region high where z >= 10 {}
}
