tool Clamped "a ball cutter in a nut" {
    units mm;
    param D = 6;
    mount "ball.tool" as cutter with D = D;
    mount "er16.tool" as nut at z = 30;
    niceness cutter.flute: 0.75;
}
