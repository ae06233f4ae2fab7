tool Mill {
    units mm;
    mount "T0516/ball.tool" as ball;
}
