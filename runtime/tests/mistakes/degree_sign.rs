touchoff::include_tool!("mistakes/degree_sign.tool");

fn main() {
    let tool: &dyn touchoff::Tool = &Cone;
    println!("{} is {} wide", tool.info().name, 2.0 * tool.info().radius());
}
