touchoff::include_tool!("mistakes/forgotten_region.tool");

fn main() {
    let tool: &dyn touchoff::Tool = &Rod;
    println!("{} is {} wide", tool.card().name, 2.0 * tool.card().radius());
}
