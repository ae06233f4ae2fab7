touchoff::include_tool!("mistakes/degree_sign.tool");

fn main() {
    let tool: &dyn touchoff::Tool = &Cone;
    println!("{} is {} wide", tool.card().name, 2.0 * tool.card().radius());
}
