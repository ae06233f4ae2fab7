touchoff::include_tool!("mistakes/pin.tool" as Thin, D = 30deg);

fn main() {
    let tool: &dyn touchoff::Tool = &Thin;
    println!("{} is {} wide", tool.info().name, 2.0 * tool.info().radius());
}
