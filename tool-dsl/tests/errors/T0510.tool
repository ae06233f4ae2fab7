tool Mill {
    units mm;
    mount "T0510/drawing.svg" as pin;
}
