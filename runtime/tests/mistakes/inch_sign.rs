touchoff::include_tool!("mistakes/inch_sign.tool");

fn main() {
    let _: &dyn touchoff::Tool = &Ball;
}
