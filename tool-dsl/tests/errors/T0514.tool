tool Mill {
    units mm;
    mount "T0514/ring.tool" as pin;
}
