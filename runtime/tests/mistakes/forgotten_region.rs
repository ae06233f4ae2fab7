touchoff::include_tool!("mistakes/forgotten_region.tool");

fn main() {
    let tool: &dyn touchoff::Tool = &Rod;
    println!("{} is {} wide", tool.info().name, 2.0 * tool.info().radius());
}
