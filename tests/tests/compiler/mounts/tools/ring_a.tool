tool RingA {
    units mm;
    mount "ring_b.tool" as b;
}
