touchoff::include_tool!("mistakes/used_above_its_definition.tool");

fn main() {
    let tool: &dyn touchoff::Tool = &Ball;
    println!("{} is {} wide", tool.card().name, 2.0 * tool.card().radius());
}
