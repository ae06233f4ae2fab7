touchoff::include_tool!("mistakes/no_semicolon_in_a_file.tool");

fn main() {
    let tool: &dyn touchoff::Tool = &Ball;
    println!("{} is {} wide", tool.card().name, 2.0 * tool.card().radius());
}
