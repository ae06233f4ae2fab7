touchoff::tool! {
    tool Mill {
        units mm;
        mount "ring.tool" as cutter;
    }
}

fn main() {
    let _: &dyn touchoff::Tool = &Mill;
}
