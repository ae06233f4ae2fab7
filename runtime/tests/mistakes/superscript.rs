touchoff::include_tool!("mistakes/superscript.tool");

fn main() {
    let _: &dyn touchoff::Tool = &Ball;
}
