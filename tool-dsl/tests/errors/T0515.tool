tool Mill {
    units mm;
    mount "T0515/block.tool" as block;
}
