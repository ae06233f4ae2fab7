tool Mill {
    units mm;
    mount "T0513/latin.tool" as pin;
}
