touchoff::tool! {
    tool Mill {
        units mm;
        mount "pin.tool" as cutter;
        mount "pin.tool" as nut with D = 20 at z = 5;
        magnitude pin: 2*depth;
    }
}

fn main() {
    let _: &dyn touchoff::Tool = &Mill;
}
