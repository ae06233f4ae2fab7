tool Mill {
    units mm;
    mount "T0506/pin.tool" as pin cutting;
}
