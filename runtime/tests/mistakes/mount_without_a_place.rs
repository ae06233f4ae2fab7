touchoff::tool! {
    tool Mill {
        units mm;
        mount "pin.tool" as cutter;
        mount "pin.tool" as nut with D = 20;
    }
}

fn main() {
    let _: &dyn touchoff::Tool = &Mill;
}
