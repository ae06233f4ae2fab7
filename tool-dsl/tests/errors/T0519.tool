tool Mill {
    units mm;
    mount "T0519/tip.tool" as tip;
    mount "T0519/pin.tool" as holder at z = 10;
}
