//! A file added to the folder is a tool added to the library; a feature of its name chooses it.

use std::path::Path;

fn main() {
    println!("cargo::rerun-if-changed=tools");
    let wanted = |feature: &str| {
        let variable = format!("CARGO_FEATURE_{}", feature.to_uppercase());
        std::env::var_os(variable).is_some()
    };
    if wanted("all") {
        return;
    }
    let files = std::fs::read_dir("tools").into_iter().flatten().flatten();
    let stems = files.filter_map(|file| {
        let stem = Path::new(&file.file_name()).file_stem()?.to_str()?.to_owned();
        wanted(&stem).then_some(stem)
    });
    // What `tool_library!` asks for.
    println!("cargo::rustc-env=TOUCHOFF_TOOLS={}", stems.collect::<Vec<_>>().join(","));
}
