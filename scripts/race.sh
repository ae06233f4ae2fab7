#!/usr/bin/env bash
# Times this version of the runtime against another, interleaved in one process:
#   scripts/race.sh COMMIT
# Prints the mean time per pose of a wrench, a contact test, a certified depth and a certified motion on each scene, and
# its ratio to the other version's. Each block of 25 poses counts with the fastest of seven passes.
set -euo pipefail
cd "$(dirname "$0")/.."
other=$(git rev-parse --verify "$1^{commit}")
here=$PWD
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
race=$folder/race
mkdir -p "$race/src" "$folder/other"
git archive "$other" | tar -x -C "$folder/other"
# Packages with the same name must differ in version.
sed -i 's/^version = .*/version = "0.0.9"/; s/\(path = "[^"]*", version = \)"[^"]*"/\1"0.0.9"/' "$folder/other/Cargo.toml"
# Before 0.2.0 the package in tools-library/ had another name.
other_tools=$(sed -n 's/^name = "\(.*\)"/\1/p' "$folder/other/tools-library/Cargo.toml")
cp scripts/race/main.rs "$race/src/main.rs"
cat > "$race/Cargo.toml" <<END
[package]
name = "race"
version = "0.0.0"
edition = "2024"
[workspace]
[dependencies]
this = { package = "touchoff", path = "$here/runtime" }
this-tools = { package = "touchoff-tools", path = "$here/tools-library" }
other = { package = "touchoff", path = "../other/runtime", version = "0.0.9" }
other-tools = { package = "$other_tools", path = "../other/tools-library", version = "0.0.9" }
END
cargo run --release --quiet --manifest-path "$race/Cargo.toml" --target-dir target/race
