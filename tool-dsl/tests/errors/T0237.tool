tool Mill {
    units mm;
    mount "T0237/pin.tool" as pin with D = 3deg;
}
