tool DrillBt40 "8.5 mm drill, 85 out of an ER16 nut on a slim BT40 chuck" {
    units mm;

    mount "drill.tool" as cutter;
    mount "holders/er16.tool" as nut at z = 85;
    mount "holders/bt40.tool" as holder at z = 102.5;
}
