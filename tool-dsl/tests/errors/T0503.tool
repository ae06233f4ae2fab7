tool Mill {
    units mm;
    mount "T0503/pin.tool" as pin;
    mount "T0503/pin.tool" as pin at z = 10;
}
