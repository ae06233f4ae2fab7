tool Mill {
    units inch;
    mount "T0238/pin.tool" as pin with ratio = 3;
}
