tool Mill {
    units mm;
    mount "T0522/mill.tool" as cutter;
    mount "T0522/nut.tool" as holder at z = 15;
}
