//! Shards of a sweep, the list of those that are left, and the map that they merge to.

use super::{Tube, object, refused};
use crate::bench::{stderr, stdout};
use std::path::Path;
use std::process::{Command, Output};

const BINARY: &str = env!("CARGO_BIN_EXE_touchoff");

/// Arguments of the sweep.
const STUDY: &str =
    "sweep --part tube.stl --unit mm --tool D2Ball,BallEr16 --directions 20 --tolerance 0.05";

impl Tube {
    fn shard(&self, shard: &str, file: &str, more: &str) -> Output {
        self.bench.touchoff(&format!("{STUDY} --shard {shard} -o {file}{more}"))
    }

    fn bytes(&self, file: &str) -> Vec<u8> {
        std::fs::read(self.bench.place(file)).expect("a file")
    }
}

#[test]
fn shards_merge_to_the_map_of_the_whole_sweep() {
    let tube = Tube::new();
    let swept = tube.bench.touchoff(&format!("{STUDY} -o whole.postures"));
    assert!(swept.status.success(), "{}", stderr(&swept));
    for (shard, file) in [("2/2", "b.parquet"), ("1/2", "a.parquet")] {
        let told = object(&tube.shard(shard, file, " --json"));
        assert_eq!((&told["shard"], &told["was_done"]), (&shard.into(), &false.into()));
    }
    // A shard that is there is not swept again.
    let before = tube.bytes("a.parquet");
    let again = tube.shard("1/2", "a.parquet", "");
    assert!(stdout(&again).contains("a.parquet has shard 1/2 already"), "{}", stderr(&again));
    assert!(tube.bytes("a.parquet") == before);
    let left = tube.bench.touchoff("merge --left b.parquet");
    assert_eq!((left.status.code(), &*stdout(&left)), (Some(3), "1/2\n"), "{}", stderr(&left));
    let left = tube.bench.touchoff("merge --left a.parquet b.parquet");
    assert_eq!((left.status.code(), &*stdout(&left)), (Some(0), ""));
    let merged = tube.bench.touchoff("merge a.parquet b.parquet -o m.postures -o m.parquet");
    assert!(stdout(&merged).contains("2 shards, 384 triangles"), "{}", stderr(&merged));
    for map in ["whole", "m"] {
        let table =
            format!("map {map}.postures --part tube.stl -o {map}-table.parquet -o {map}.csv");
        let written = tube.bench.touchoff(&table);
        assert!(written.status.success(), "{}", stderr(&written));
    }
    assert!(tube.bytes("whole-table.parquet") == tube.bytes("m.parquet"));
    assert!(tube.bytes("m-table.parquet") == tube.bytes("m.parquet"));
    assert!(tube.bytes("whole.csv") == tube.bytes("m.csv"));
    let other_order = tube.bench.touchoff("merge b.parquet a.parquet -o n.postures");
    assert!(other_order.status.success(), "{}", stderr(&other_order));
    assert!(tube.bytes("n.postures") == tube.bytes("m.postures"));
}

#[test]
fn what_does_not_belong_together_is_named() {
    let tube = Tube::new();
    for (shard, file) in [("1/2", "a.parquet"), ("2/2", "b.parquet"), ("2/3", "c.parquet")] {
        assert!(tube.shard(shard, file, "").status.success());
    }
    let gives = |line: &str, words: &[&str]| refused(&tube.bench.touchoff(line), words);
    gives("merge a.parquet -o m.postures", &["1 of 2 shards are left, the first of them 2/2"]);
    gives("merge a.parquet a.parquet -o m.postures", &["are both shard 1/2"]);
    gives("merge a.parquet c.parquet -o m.postures", &["c.parquet is shard 2/3, and a.parquet"]);
    gives("merge a.parquet tube.stl -o m.postures", &["tube.stl is no shard of a sweep"]);
    gives("merge a.parquet b.parquet -o m.csv", &["merged to a map (`.postures`) or a table"]);
    refused(&tube.shard("2/3", "a.parquet", ""), &["a.parquet has shard 1/2, and not 2/3"]);
    refused(&tube.shard("1/2", "c.postures", ""), &["a shard is written as `.parquet`"]);
    tube.bench.write("notes.parquet", "kept");
    refused(&tube.shard("1/2", "notes.parquet", ""), &["notes.parquet is no shard of a sweep"]);
    assert_eq!(tube.bytes("notes.parquet"), b"kept");
    // A node that was switched off while it wrote: the file is named, and its shard is left.
    let whole = tube.bytes("b.parquet");
    tube.bench.write("cut.parquet", "");
    std::fs::write(tube.bench.place("cut.parquet"), &whole[..whole.len() / 2]).expect("a file");
    gives(
        "merge a.parquet cut.parquet -o m.postures",
        &["cut.parquet is damaged", "run its shard again"],
    );
    let left = tube.bench.touchoff("merge --left a.parquet cut.parquet");
    assert_eq!((left.status.code(), &*stdout(&left)), (Some(3), "2/2\n"));
    assert!(stderr(&left).contains("cut.parquet is damaged"), "{}", stderr(&left));
    gives(
        "merge --left cut.parquet",
        &["cut.parquet is damaged", "no shard is given that can be read"],
    );
    // It is swept again, and then it is whole.
    let again = tube.shard("2/2", "cut.parquet", "");
    assert!(stdout(&again).contains("shard 2/2: "), "{}", stderr(&again));
    assert!(tube.bytes("cut.parquet") == whole);
    assert!(!Path::new(&tube.bench.place("m.postures")).exists());
    // The other shard was swept by another tool.
    let other = STUDY.replace("D2Ball,", "");
    assert!(tube.bench.touchoff(&format!("{other} --shard 2/2 -o d.parquet")).status.success());
    gives(
        "merge a.parquet d.parquet -o m.postures",
        &["d.parquet is of another sweep than a.parquet", "tools"],
    );
}

/// A full disk: nothing is left of the shard, and the reason is said.
#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_leaves_no_shard() {
    let tube = Tube::new();
    let limited = Command::new("bash")
        .args([
            "-c",
            &format!("ulimit -f 1; trap '' XFSZ; exec \"$0\" {STUDY} --shard 1/2 -o a.parquet"),
        ])
        .arg(BINARY)
        .current_dir(tube.bench.folder.path())
        .output()
        .expect("a run");
    refused(&limited, &["cannot write a.parquet"]);
    assert!(!Path::new(&tube.bench.place("a.parquet")).exists());
}

/// Runs the recipe of `docs/scale.md` for GNU parallel, if that is installed, with another part.
#[test]
fn the_recipe_for_gnu_parallel_works() {
    if Command::new("parallel").arg("--version").output().is_err() {
        eprintln!("not tested: the recipe for GNU parallel, which is not installed");
        return;
    }
    let tube = Tube::new();
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/scale.md");
    let page = std::fs::read_to_string(page).expect("the page");
    let block = page.split("```sh\n").find(|block| block.contains("| parallel"));
    let recipe = block.and_then(|block| block.split("```").next()).expect("a recipe");
    let folder = Path::new(BINARY).parent().expect("a folder").to_owned();
    let path = std::env::var("PATH").unwrap_or_default();
    let run = Command::new("bash")
        .args(["-euc", &recipe.replace("part.stl", "tube.stl")])
        .env("PATH", format!("{}:{path}", folder.display()))
        .current_dir(tube.bench.folder.path())
        .output()
        .expect("a run");
    assert!(run.status.success(), "{recipe}{}", stderr(&run));
    assert!(stdout(&run).contains("16 shards, 384 triangles"), "{}{}", stdout(&run), stderr(&run));
}
