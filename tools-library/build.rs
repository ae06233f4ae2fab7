//! A file added to the folder is a tool added to the library.

fn main() {
    println!("cargo::rerun-if-changed=tools");
}
