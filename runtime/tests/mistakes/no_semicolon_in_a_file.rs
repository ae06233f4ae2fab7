touchoff::include_tool!("mistakes/no_semicolon_in_a_file.tool");

fn main() {
    let tool: &dyn touchoff::Tool = &Ball;
    println!("{} is {} wide", tool.info().name, 2.0 * tool.info().radius());
}
