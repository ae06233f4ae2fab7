//! The section of `compile.md` on bounds: what is proved about every library tool, and in what time.

use std::error::Error;
use std::fmt::Write;
use std::time::Instant;
use touchoff_bench::compile::sources;
use touchoff_bench::page::Section;
use touchoff_dsl::compile;
use touchoff_dsl::diagnostic::format_number;
use touchoff_dsl::prove::Certificate;

/// Returns the section about all library tools.
pub(super) fn section() -> Result<Section, Box<dyn Error>> {
    let mut body = "\
`c · distance ≤ depth ≤ L · distance`, and depth is L-Lipschitz; how, is in `docs/proofs.md`. **Joins** are borders of two
regions on which depths agree exactly, by an identity; **corners** are pairs of regions that meet in a point only or on a border that is
smooth but for rounding, where they agree to the tolerance. **Slack** is how far depth may be off its bounds, in the file's unit. **Open** are
boxes where the proof did not come to an end. Times are those of the proof alone.

| tool | regions | c | L | slack | a distance | joins | corners | jumps | open | boxes | ms |
|---|--:|--:|--:|--:|---|--:|--:|--:|--:|--:|--:|
"
        .to_owned();
    for source in sources() {
        let tool = compile(&source).into_tool().ok_or("a tool of the library has an error")?;
        let start = Instant::now();
        let proved = Certificate::prove(&tool);
        let milliseconds = 1e3 * start.elapsed().as_secs_f64();
        let inner = || proved.borders.iter().filter(|border| border.sides.other.is_some());
        let count = |accept: &dyn Fn(f64) -> bool| {
            inner().filter(|border| accept(border.depth_jump.high)).count()
        };
        let bound = |bound: Option<f64>| bound.map_or("-".to_owned(), format_number);
        writeln!(
            body,
            "| {} | {} | {} | {} | {:.0e} | {} | {} | {} | {} | {} | {} | {milliseconds:.1} |",
            tool.model.name,
            tool.model.regions.len(),
            bound(proved.lower_slope()),
            bound(proved.lipschitz()),
            proved.slack,
            if proved.is_exact() { "yes" } else { "no" },
            count(&|jump| jump == 0.0),
            count(&|jump| jump > 0.0 && jump <= proved.tolerance),
            count(&|jump| jump > proved.tolerance),
            proved.undecided.len(),
            proved.examined_boxes,
        )?;
    }
    Ok(Section { title: "Proved", body })
}
