tool Mill {
    units mm;
    mount "T0505/pin.tool" as cutting;
}
