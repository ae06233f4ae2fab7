tool Mill {
    units mm;
    mount "T0501/pin.tool" as pin;
    profile {
        start (0, 0);
        line to (3, 0) as face cutting;
        line to (3, 20) as side cutting;
        line to (0, 20) as top;
    }
}
