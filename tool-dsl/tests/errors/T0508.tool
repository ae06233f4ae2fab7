tool Mill {
    units mm;
    mount "T0508/pin.tool" as pin;
    mount "T0508/pin.tool" as holder;
}
