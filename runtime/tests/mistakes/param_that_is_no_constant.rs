touchoff::include_tool!("mistakes/pin.tool", D = diameter);

fn main() {
    let tool: &dyn touchoff::Tool = &Pin;
    println!("{} is {} wide", tool.info().name, 2.0 * tool.info().radius());
}
