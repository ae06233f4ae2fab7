tool Mill {
    units mm;
    mount "T0502/pin.tool" as pin;
    tip z = 0;
}
