//! Without a build script, Cargo passes over what one needs, and the features of what macros are made from.
fn main() {}
