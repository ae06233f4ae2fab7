//! Run time against error, as words: which scenes, rows as they come, a page at the end.

use crate::arguments::{ALL_SCENES, Bench};
use crate::failure::Failure;
use crate::files::Found;
use crate::output::{Output, refuse_inputs, unwritable};
use crate::program;
use std::io::Write;
use std::path::{Path, PathBuf};
use touchoff::mesh::Shape;
use touchoff::{AtomicFile, Unit};
use touchoff_tests::measure::bench::{self, Own, Plan, Row};

/// Measures, and prints a row at a time.
pub(crate) fn bench(wanted: &Bench, json: bool) -> Result<(), Failure> {
    if let Some(folder) = &wanted.out {
        let part = wanted.part.as_deref();
        let own = part.map(name_of);
        let scenes = scenes(wanted).into_iter().chain(own.as_deref());
        let outputs: Vec<PathBuf> = bench::files(folder, scenes).collect();
        let tool = wanted.tool.as_deref().map(Path::new);
        let inputs = part.into_iter().chain(tool).chain(wanted.path.as_deref());
        refuse_inputs(outputs.iter().map(PathBuf::as_path), inputs)?;
        // Before minutes are spent: a folder that cannot be written is known now.
        std::fs::create_dir_all(folder).map_err(|source| unwritable(folder, source))?;
        for output in &outputs {
            AtomicFile::create(output).map_err(|source| unwritable(output, source))?;
        }
    }
    let found = match &wanted.tool {
        Some(name) => Some(Found::find(name, &wanted.given)?),
        None if wanted.given.is_none() => None,
        None => return Err(Failure::NothingToSet("name one with `--tool`")),
    };
    let own = match (&wanted.part, wanted.unit, &found, &wanted.path) {
        (Some(part), Some(unit), Some(found), Some(path)) => Some(own(part, unit, found, path)?),
        _ => None,
    };
    let plan = if wanted.quick { Plan::quick(wanted.seed) } else { Plan::full(wanted.seed) };
    let mut out = Output::lines();
    if !json {
        writeln!(out, "{}", bench::head())?;
    }
    // A reader who has enough of it ends the rows, not the measurement of a page.
    let mut failed = None;
    let mut print = |row: Row| {
        if failed.is_none() {
            let line = if json { row.json() } else { bench::line(&row) };
            failed = writeln!(out, "{line}").and_then(|()| out.flush()).err();
        }
    };
    let measured = bench::measure(&scenes(wanted), own, &plan, &mut print)?;
    if let Some(folder) = &wanted.out {
        bench::write(folder, &measured, &plan, &command(wanted))
            .map_err(|source| unwritable(folder, source))?;
    }
    failed.map_or(Ok(()), |error| Err(error.into()))
}

/// The scenes that are meant.
fn scenes(wanted: &Bench) -> Vec<&str> {
    let said = wanted.scene.iter().map(String::as_str);
    let all = wanted.scene.iter().any(|word| word == ALL_SCENES);
    if all || (wanted.scene.is_empty() && wanted.part.is_none()) {
        return bench::scenes();
    }
    said.collect()
}

fn own<'t>(part: &Path, unit: Unit, found: &'t Found, path: &Path) -> Result<Own<'t>, Failure> {
    let tool = found.tool();
    let program = program::read(path, tool.card(), unit)?;
    let file = part.display().to_string();
    let Shape::Mesh(mesh) = Shape::read(part, unit)? else {
        return Err(Failure::NoTriangles { file, what: "touchoff bench" });
    };
    for finding in mesh.survey().findings() {
        say!("{file}: {finding}");
    }
    let name = name_of(part);
    let poses = program.stops.iter().map(|stop| stop.pose).collect();
    let compiled = matches!(found, Found::Compiled(_));
    Ok(Own { mesh, name, tool, compiled, poses })
}

/// The name of a part's scene.
fn name_of(part: &Path) -> String {
    part.file_stem().map_or("part".into(), |stem| stem.to_string_lossy().into_owned())
}

/// The command that measures the same, with names of files in the place of paths.
fn command(wanted: &Bench) -> String {
    let name = |path: &Path| path.file_name().map_or(String::new(), |n| n.to_string_lossy().into());
    let mut words = vec!["touchoff bench".to_owned()];
    if wanted.quick {
        words.push("--quick".to_owned());
    }
    words.push(format!("--seed {}", wanted.seed));
    if !wanted.scene.is_empty() {
        words.push(format!("--scene {}", wanted.scene.join(",")));
    }
    if let (Some(part), Some(unit), Some(tool), Some(path)) =
        (&wanted.part, wanted.unit, &wanted.tool, &wanted.path)
    {
        let [part, path] = [part, path].map(|path| name(path));
        words.push(format!(
            "--part {part} --unit {} --tool {} --path {path}",
            unit.word(),
            tool.display()
        ));
    }
    if let Some(folder) = &wanted.out {
        words.push(format!("--out {}", folder.display()));
    }
    words.join(" ")
}
