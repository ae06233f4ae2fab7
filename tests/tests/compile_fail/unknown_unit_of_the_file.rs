touchoff::include_tool!("mistakes/unknown_unit_of_the_file.tool");

fn main() {
    let tool: &dyn touchoff::Tool = &Ball;
    println!("{} is {} wide", tool.card().name, 2.0 * tool.card().radius());
}
