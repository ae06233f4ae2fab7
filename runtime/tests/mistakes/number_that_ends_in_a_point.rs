touchoff::include_tool!("mistakes/number_that_ends_in_a_point.tool");

fn main() {
    let _: &dyn touchoff::Tool = &Ball;
}
