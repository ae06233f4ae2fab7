//! Compares interpreted tools with the same tools compiled: the same queries in one process, interleaved pose by pose.

use std::error::Error;
use std::fmt::Write;
use std::time::Instant;
use touchoff::scenes::{ScenePath, tube};
use touchoff::tool::{Interpreted, Tool};
use touchoff::{Cloud, Law, Part, Pose, Probe, Sampling};
use touchoff_bench::page::Section;
use touchoff_tests::library::library;

/// Number of poses per row; each is queried once per tool, so that branch predictors learn no pose.
const POSES: usize = 4_000;

/// Returns the section about all library tools.
pub(super) fn section() -> Result<Section, Box<dyn Error>> {
    let cloud = Cloud::sample(&tube(), Sampling::monte_carlo(20_000))?;
    let part = Part::from_cloud(&cloud);
    let mut body = format!(
            "Wrenches at {POSES} poses along the tube of 20,000 points, each pose asked once of both, interleaved; median ns a query.
The forces are equal to the bit.

| tool | path | contacts | compiled | interpreted | ratio |
|---|---|---|---|---|---|
"
        );
    let mut ratios = Vec::new();
    for source in library() {
        let Ok(loaded) = Interpreted::parse(&source) else { continue };
        let Some(compiled) = touchoff_tools::find(&loaded.info().name) else { continue };
        let name = &loaded.info().name;
        eprintln!("{name}");
        for path in [ScenePath::Outside, ScenePath::Inside] {
            let (contacts, [compiled_time, interpreted_time]) =
                measure(&part, [compiled, &loaded], path);
            let ratio = interpreted_time / compiled_time;
            ratios.push(ratio);
            writeln!(
                body,
                "| {name} | {} | {contacts:.1} | {compiled_time:.0} | {interpreted_time:.0} | {ratio:.1} |",
                path.name()
            )?;
        }
    }
    ratios.sort_by(f64::total_cmp);
    let worst = ratios.last().ok_or("the library has no tool")?;
    writeln!(body, "\nMedian ratio {:.1}, worst {worst:.1}.", ratios[ratios.len() / 2])?;
    Ok(Section { title: "Loaded at run time", body })
}

/// Returns the mean number of contacts, and the median time per query of each tool, ns.
fn measure(part: &Part, tools: [&dyn Tool; 2], path: ScenePath) -> (f64, [f64; 2]) {
    let mut probes = tools.map(|tool| Probe::new(part, tool).with_law(Law::Thesis));
    let mut times = [Vec::with_capacity(POSES), Vec::with_capacity(POSES)];
    let mut contacts = 0;
    for k in 0..POSES {
        let pose: Pose = path.pose(k, POSES);
        let order = if k % 2 == 0 { [0, 1] } else { [1, 0] };
        let mut forces = [None; 2];
        for index in order {
            let start = Instant::now();
            let evaluation = probes[index].wrench(&pose);
            times[index].push(start.elapsed().as_secs_f64() * 1e9);
            contacts += evaluation.colliding;
            forces[index] = Some(evaluation.force);
        }
        assert_eq!(forces[0], forces[1], "both do the same operations");
    }
    times.iter_mut().for_each(|times| times.sort_by(f64::total_cmp));
    (contacts as f64 / (2 * POSES) as f64, times.map(|times| times[POSES / 2]))
}
