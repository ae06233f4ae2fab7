touchoff::tool! {
    tool Mill {
        units mm;
        mount "pin.tool" as cutter;
        mount "nut.tool" as nut at z = 5;
    }
}

fn main() {
    let tool: &dyn touchoff::Tool = &Mill;
    println!("{} is {} wide", tool.info().name, 2.0 * tool.info().radius());
}
