tool Mill {
    units mm;
    mount "T0236/pin.tool" as pin with D = 8, D = 9;
}
