//! A recording process is killed at random moments: every batch that it acknowledged is on disk.
//!
//! The environment variable `TOUCHOFF_KILLS` sets the number of kills; the default is 20.

use nalgebra::Point3;
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::LazyLock;
use std::time::Duration;
use std::{env, fs, thread};
use touchoff::TriangleId;
use touchoff::mesh::shapes;
use touchoff::tool::Interpreted;
use touchoff::{Mesh, Unit};
use touchoff_postures::{Accessibility, MapIdentity, MapRow, PostureMap, PostureRecord, Rules};

static BALL: LazyLock<Interpreted> = LazyLock::new(|| {
    r#"tool Ball "a ball" {
        units mm;
        profile { start (0, 0); arc to (0, 6) center (0, 3) as ball cutting; }
        niceness cutting: 1;
    }"#
    .parse()
    .expect("a tool")
});

/// Environment variable for the path of the map that the killed process records into.
const MAP_PATH_VARIABLE: &str = "TOUCHOFF_KILLED_MAP";
/// Environment variable for the number of its first batch.
const FIRST_BATCH_VARIABLE: &str = "TOUCHOFF_KILLED_FIRST";
/// Number of triangles per batch.
const TRIANGLES_PER_BATCH: u32 = 40;

fn sphere() -> Mesh {
    shapes::sphere(8.0, 4, Unit::Millimetre).expect("a sphere")
}

fn identity() -> MapIdentity {
    let rules = Rules { tolerance: 0.01, niceness: 0.0, allowed: Vec::new() };
    let identity = MapIdentity::new(&sphere(), &[&*BALL], rules).expect("rules");
    identity.with_directions(vec![[0.0, 0.0, 1.0]; 600])
}

/// Returns the rows of batch `k`, each of which identifies the batch.
fn batch(k: u32, triangles: u32) -> Vec<(TriangleId, MapRow)> {
    let row = |triangle: u32| {
        let record = PostureRecord {
            tool: 0,
            tip: Point3::new(f64::from(k), f64::from(triangle), 0.5).into(),
            axis: [0.0, 0.0, 1.0],
            niceness: f64::from(k),
            depth: 0.001,
            clearance: 2.0,
        };
        let directions = (0..10).map(|word| (u64::from(k) * word) >> 8).collect();
        let access = Accessibility { tool: 0, directions, stickout: Some(f64::from(triangle)) };
        MapRow { best: vec![record], access: vec![access] }
    };
    (0..TRIANGLES_PER_BATCH)
        .map(|index| (k * 7 + index * 3) % triangles)
        .map(|id| (TriangleId(id), row(id)))
        .collect()
}

/// Records one batch after another and acknowledges each, until it is killed. Run by itself it does nothing:
/// the test below calls it.
#[test]
#[ignore = "the process that is killed"]
fn records_until_it_is_killed() {
    let (Ok(path), Ok(first)) = (env::var(MAP_PATH_VARIABLE), env::var(FIRST_BATCH_VARIABLE))
    else {
        return;
    };
    let map = PostureMap::open(path, &identity()).expect("a map");
    let triangles = map.identity().part.triangles;
    for k in first.parse().expect("a number").. {
        map.record(&batch(k, triangles)).expect("recorded");
        let mut out = std::io::stdout();
        writeln!(out, "recorded {k}").and_then(|()| out.flush()).expect("said");
    }
}

/// Starts a process that records from batch `first` on, waits for a number of acknowledgements and then for a delay,
/// and kills it. Returns the last acknowledged batch.
fn run_and_kill(
    path: &Path,
    first: u32,
    (acknowledgements, delay): (u32, Duration),
) -> Option<u32> {
    let mut child = Command::new(env::current_exe().expect("a path"))
        .args(["--exact", "crash::records_until_it_is_killed", "--ignored", "--nocapture"])
        .env(MAP_PATH_VARIABLE, path)
        .env(FIRST_BATCH_VARIABLE, first.to_string())
        .stdout(Stdio::piped())
        .spawn()
        .expect("a process");
    let lines = BufReader::new(child.stdout.take().expect("a pipe")).lines();
    let mut batches =
        lines.map_while(Result::ok).filter_map(|line| line.split_once("recorded ")?.1.parse().ok());
    let mut last = None;
    for _ in 0..acknowledgements {
        last = batches.next();
    }
    thread::sleep(delay);
    child.kill().expect("killed");
    child.wait().expect("over");
    batches.last().or(last)
}

#[test]
fn acknowledged_batches_survive_a_crash() {
    let kills = match env::var_os("TOUCHOFF_KILLS") {
        None => 20,
        Some(text) => match text.to_str().and_then(|text| text.parse().ok()) {
            Some(kills) if kills > 0 => kills,
            _ => panic!("TOUCHOFF_KILLS is {text:?}: give a whole number above 0"),
        },
    };
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("killed.postures");
    let triangles = identity().part.triangles;
    let mut random = Pcg64Mcg::seed_from_u64(1);
    let mut expected: Vec<Option<MapRow>> = vec![None; triangles as usize];
    let (mut next, mut acknowledged_total, mut unacknowledged, mut without_map) = (0, 0, 0, 0);
    for kill in 0..kills {
        // One kill of four comes while the map is created, the others while it is opened or during a batch.
        let is_new_map = kill % 4 == 0;
        if is_new_map && path.exists() {
            fs::remove_file(&path).expect("removed");
        }
        if is_new_map {
            expected.fill(None);
            next = 0;
        }
        let acknowledgements = if is_new_map { 0 } else { random.next_u32() % 10 };
        let max_delay = if is_new_map { 25_000 } else { 8_000 };
        let delay = Duration::from_micros(u64::from(random.next_u32() % max_delay));
        let last = run_and_kill(&path, next, (acknowledgements, delay));
        for k in next..last.map_or(next, |last| last + 1) {
            batch(k, triangles).into_iter().for_each(|(id, row)| expected[id.index()] = Some(row));
            acknowledged_total += 1;
        }
        next = last.map_or(next, |last| last + 1);
        if last.is_none() && !path.exists() {
            without_map += 1;
            continue;
        }
        let map = PostureMap::open(&path, &identity()).expect("it opens");
        let rows: Vec<(TriangleId, MapRow)> =
            map.rows().expect("rows").map(|row| row.expect("whole")).collect();
        let mut found: Vec<Option<MapRow>> = vec![None; triangles as usize];
        rows.into_iter().for_each(|(id, row)| found[id.index()] = Some(row));
        if found != expected {
            // One more batch may be on disk, whole, that could not be acknowledged.
            let extra_batch = batch(next, triangles);
            extra_batch.into_iter().for_each(|(id, row)| expected[id.index()] = Some(row));
            assert!(found == expected, "kill {kill}, after batch {next}");
            (next, unacknowledged) = (next + 1, unacknowledged + 1);
        }
    }
    println!(
        "{kills} kills, {without_map} before there was a map: {acknowledged_total} batches were acknowledged, and \
         all are on disk, with {unacknowledged} more"
    );
    assert!(acknowledged_total >= kills, "{acknowledged_total} batches in {kills} processes");
}
