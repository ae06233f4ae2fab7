touchoff::tool! {
    tool Mill {
        units mm;
        mount "pin.tool" as cutter with long = 8;
        mount "pin.tool" as nut with D = 20 at z = 10;
    }
}

fn main() {
    let tool: &dyn touchoff::Tool = &Mill;
    println!("{} is {} wide", tool.info().name, 2.0 * tool.info().radius());
}
