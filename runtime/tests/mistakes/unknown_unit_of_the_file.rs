touchoff::include_tool!("mistakes/unknown_unit_of_the_file.tool");

fn main() {
    let tool: &dyn touchoff::Tool = &Ball;
    println!("{} is {} wide", tool.info().name, 2.0 * tool.info().radius());
}
