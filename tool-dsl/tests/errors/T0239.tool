tool Mill {
    units mm;
    mount "T0239/pin.tool" as pin with Dia = 8;
}
