touchoff::tool! {
    tool Mill {
        units mm;
        mount "pin.tool" as cutter;
        mount "nut.tool" as nut at z = 5;
    }
}

fn main() {
    let tool: &dyn touchoff::Tool = &Mill;
    println!("{} is {} wide", tool.card().name, 2.0 * tool.card().radius());
}
