tool Mill {
    units mm;
    mount "../other/pin.tool" as pin;
}
