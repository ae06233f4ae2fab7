tool Ring {
    units mm;
    mount "ring.tool" as part;
}
