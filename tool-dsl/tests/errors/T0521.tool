tool Mill {
    units mm;
    mount "T0521/pin.tool" as pin;
    mount "T0521/ball.tool" as ball at z = 10;
}
