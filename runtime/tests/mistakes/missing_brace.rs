// Without its end a tool has no name yet, so nothing can stand in for it.
touchoff::include_tool!("mistakes/missing_brace.tool");

fn main() {}
