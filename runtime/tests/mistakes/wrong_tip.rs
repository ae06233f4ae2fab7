touchoff::include_tool!("mistakes/wrong_tip.tool");

fn main() {
    let tool: &dyn touchoff::Tool = &Ball;
    println!("{} is {} wide", tool.info().name, 2.0 * tool.info().radius());
}
