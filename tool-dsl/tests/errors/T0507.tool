tool Mill {
    units mm;
    mount "T0507/pin.tool" as pin at z = 3;
}
