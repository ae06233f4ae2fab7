tool BallEr16 "6 mm ball end mill, 30 out of an ER16 nut" {
    units mm;
    param stickout = 30;

    mount "ball.tool" as cutter with D = 6, flute = 18;
    mount "holders/er16.tool" as nut at z = stickout;
}
