tool RingB {
    units mm;
    mount "ring_a.tool" as a;
}
