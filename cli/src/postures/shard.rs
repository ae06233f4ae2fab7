//! `touchoff sweep --shard`: one part of a sweep, in a file of its own; and `touchoff merge`, which joins them.

use crate::arguments::postures::Merge as Arguments;
use crate::failure::Failure;
use crate::output::{Output, extension, refuse_inputs};
use crate::progress::Progress;
use serde::Serialize;
use std::io::Write;
use std::ops::ControlFlow;
use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;
use touchoff::{Mesh, Shard};
use touchoff_postures::MapIdentity;
use touchoff_postures::shard::{Merge, ShardError, is_done, shard_bytes, write_shard};
use touchoff_postures::sweep::{PostureSweep, SweepStats};

/// Exit status if shards are left.
const LEFT: u8 = 3;

/// Summary of a shard. Numbers are of what was swept now.
#[derive(Serialize)]
struct Summary {
    shard: String,
    triangles: usize,
    postures: u64,
    acceptable: u64,
    time_s: f64,
    /// Set if the file had the shard already.
    was_done: bool,
}

/// Sweeps the batches of a shard, and writes its file.
///
/// # Errors
/// If the file has something else, or cannot be written.
pub(super) fn sweep(
    sweep: &PostureSweep<'_>,
    mesh: &Mesh,
    identity: &MapIdentity,
    shard: Shard,
    file: &Path,
    json: bool,
) -> Result<(), Failure> {
    if !is_table(file) {
        return Err(Failure::Format {
            formats: "a shard is written as `.parquet`",
            file: file.display().to_string(),
        });
    }
    let was_done = is_done(file, identity, shard)?;
    let batches: Vec<usize> =
        if was_done { Vec::new() } else { shard.range(sweep.batches()).collect() };
    let (mut rows, mut stats) = (Vec::new(), SweepStats::default());
    let start = Instant::now();
    let progress = Progress::steps(batches.len(), "batches", json);
    let _: ControlFlow<()> = sweep.run(&batches, |batch| {
        progress.advance(1);
        stats += batch.stats;
        rows.extend(batch.rows);
        ControlFlow::Continue(())
    });
    drop(progress);
    let triangles = rows.len();
    if !was_done {
        write_shard(file, &shard_bytes(mesh, identity, shard, rows))?;
    }
    let summary = Summary {
        shard: shard.to_string(),
        triangles,
        postures: stats.postures(),
        acceptable: stats.acceptable,
        time_s: start.elapsed().as_secs_f64(),
        was_done,
    };
    let mut out = Output::lines();
    if json {
        out.json(&summary)?;
    } else if was_done {
        writeln!(out, "{} has shard {shard} already", file.display())?;
    } else {
        writeln!(
            out,
            "shard {shard}: {triangles} triangles, {} postures in {:.1} s",
            summary.postures, summary.time_s
        )?;
    }
    Ok(out.flush()?)
}

/// Joins shards, or lists those that are left.
pub(crate) fn merge(arguments: &Arguments, json: bool) -> Result<ExitCode, Failure> {
    refuse_inputs(
        arguments.output.iter().map(|file| &**file),
        arguments.files.iter().map(|f| &**f),
    )?;
    if let Some(file) = arguments.output.iter().find(|file| !is_map(file) && !is_table(file)) {
        return Err(Failure::Format {
            formats: "shards are merged to a map (`.postures`) or a table (`.parquet`)",
            file: file.display().to_string(),
        });
    }
    let mut merge = Merge::new();
    let mut has_failed = false;
    for file in &arguments.files {
        match merge.add(file) {
            Ok(_) => {}
            // A shard that cannot be read is left.
            Err(error) if arguments.left => {
                has_failed = true;
                message!("error: {error}");
            }
            Err(error) => return Err(error.into()),
        }
    }
    let mut out = Output::lines();
    if arguments.left {
        if merge.is_empty() {
            // Nothing says how many shards there are.
            return Err(ShardError::Empty.into());
        }
        let left: Vec<Shard> = merge.left().collect();
        for shard in &left {
            match json {
                true => out.json(&shard.to_string())?,
                false => writeln!(out, "{shard}")?,
            }
        }
        out.flush()?;
        let is_done = left.is_empty() && !has_failed;
        return Ok(if is_done { ExitCode::SUCCESS } else { ExitCode::from(LEFT) });
    }
    let merged = merge.finish()?;
    for file in &arguments.output {
        match is_table(file) {
            true => merged.write_table(file)?,
            false => merged.write_map(file)?,
        }
        message!("{}", file.display());
    }
    let (part, shards) = (merged.identity().part, arguments.files.len());
    let triangles = part.triangles;
    if json {
        out.json(&serde_json::json!({ "shards": shards, "triangles": triangles }))?;
    } else {
        writeln!(out, "{shards} shards, {triangles} triangles")?;
    }
    out.flush()?;
    Ok(ExitCode::SUCCESS)
}

fn is_table(file: &Path) -> bool {
    extension(file).as_deref() == Some("parquet")
}

fn is_map(file: &Path) -> bool {
    extension(file).as_deref() == Some("postures")
}
