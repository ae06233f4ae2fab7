touchoff::include_tool!("mistakes/pin.tool" as thin_pin);

fn main() {}
