tool Mill {
    units mm;
    mount "T0518/pin.tool" as pin;
    mount "T0518/pin.tool" as holder at z = 60;
}
