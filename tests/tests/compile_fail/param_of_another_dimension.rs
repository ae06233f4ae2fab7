touchoff::include_tool!("mistakes/pin.tool" as Thin, D = 30deg);

fn main() {
    let tool: &dyn touchoff::Tool = &Thin;
    println!("{} is {} wide", tool.card().name, 2.0 * tool.card().radius());
}
