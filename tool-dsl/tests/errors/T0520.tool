tool Mill {
    units mm;
    mount "T0520/hook.tool" as hook;
    mount "T0520/pin.tool" as holder at z = 4;
}
