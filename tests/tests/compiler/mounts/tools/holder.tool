tool Holder "an ER16 nut on a body" {
    units mm;
    mount "er16.tool" as nut;
    mount "body.tool" as body at z = 17.5;
}
