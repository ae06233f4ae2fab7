touchoff::include_tool!("mistakes/unclosed_parenthesis.tool");

fn main() {
    let _: &dyn touchoff::Tool = &Ball;
}
