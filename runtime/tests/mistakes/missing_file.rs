// Nothing is known of the tool, not even its name: only the file is complained of here.
touchoff::include_tool!("mistakes/no_such_file.tool");

fn main() {}
