tool HalfInchBallCat40 "1/2 in ball end mill, 2 in out of a CAT40 holder of 1 3/4 in" {
    units inch;
    param stickout = 2;

    mount "ball.tool" as cutter with D = 0.5inch, flute = 1inch, length = 4inch;
    mount "holders/cat40.tool" as holder at z = stickout;
}
