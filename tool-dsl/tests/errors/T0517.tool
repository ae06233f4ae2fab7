tool Mill {
    units mm;
    mount "T0517/pin.tool" as pin;
    mount "T0517/pin.tool" as holder at z = 0;
}
