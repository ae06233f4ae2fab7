touchoff::include_tool!("mistakes/sign_from_a_drawing.tool");

fn main() {
    let _: &dyn touchoff::Tool = &Ball;
}
