tool BullNoseHsk63 "12 mm bull nose end mill, 45 out of an ER32 chuck HSK-A63" {
    units mm;
    param stickout = 45;

    mount "bull_nose.tool" as cutter;
    mount "holders/er32.tool" as nut at z = stickout;
    mount "holders/hsk63.tool" as holder at z = stickout + 22.5;
}
