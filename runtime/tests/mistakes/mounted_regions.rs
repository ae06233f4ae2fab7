touchoff::tool! {
    tool Mill {
        units mm;
        mount "pin.tool" as cutter;
        mount "hand.tool" as nut at z = 5;
    }
}

fn main() {
    let _: &dyn touchoff::Tool = &Mill;
}
