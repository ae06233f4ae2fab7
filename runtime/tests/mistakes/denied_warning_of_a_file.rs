#![deny(warnings)]

touchoff::include_tool!("mistakes/flat_pin.tool");

fn main() {
    let _: &dyn touchoff::Tool = &Pin;
}
