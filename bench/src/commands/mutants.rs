//! The section of `proofs.md` about tools with deliberate defects.

use std::error::Error;
use std::fmt::Write;
use tool_dsl::compile;
use tool_dsl::prove::Certificate;
use touchoff_bench::mutants::{Detection, KINDS, detect, differs, mutants};
use touchoff_bench::page::Section;
use touchoff_tests::library::library;

/// Number of mutants per tool.
const MUTANTS_PER_TOOL: usize = 20;
/// Number of columns with counts: all mutants, equivalent mutants, and one per variant of [`Detection`].
const COLUMNS: usize = 7;

/// Makes mutants of every library tool and returns the section that counts which of them the proofs detect.
pub(super) fn section() -> Result<Section, Box<dyn Error>> {
    let mut body = format!(
            "Every tool is broken {MUTANTS_PER_TOOL} times, in one place each, after it was compiled; and `touchoff check`'s proof is made once more. **Alike** are
those that are no other solid, depth or direction at 20,000 points. The rest are seen by an **error**, with a point where depth
jumps; by a warning of a proof that stays **open**; by another **warning**, with a point where the direction is not that of steepest descent; only by
**comparing** the certificate with that of the tool before it was broken, which nobody has who writes a tool; or **not**. Of no whole tool is
anything reported.

| tool | broken | alike | error | open | warning | comparing | not |
|---|--:|--:|--:|--:|--:|--:|--:|
"
        );
    let mut undetected = Vec::new();
    let (mut totals, mut by_kind) = ([0; COLUMNS], vec![[0; 3]; KINDS.len()]);
    for (seed, source) in library().iter().enumerate() {
        let tool = *compile(source).into_tool().ok_or("a tool of the library has an error")?;
        let proved = Certificate::prove(&tool);
        if let Some(diagnostic) = proved.diagnostics(&tool).first() {
            return Err(format!(
                "{} is not broken, and: {}",
                tool.model.name,
                diagnostic.message()
            )
            .into());
        }
        eprintln!("{}", tool.model.name);
        let mut counts = [0; COLUMNS];
        for mutant in mutants(&tool, MUTANTS_PER_TOOL, seed as u64) {
            counts[0] += 1;
            if !differs(&tool, &mutant.tool, 1) {
                counts[1] += 1;
                continue;
            }
            let (column, detection) = match detect(&proved, &mutant.tool) {
                Detection::Error => (2, 0),
                Detection::Undecided => (3, 0),
                Detection::Warning => (4, 0),
                Detection::ByComparison => (5, 1),
                Detection::Undetected => (6, 2),
            };
            counts[column] += 1;
            by_kind[mutant.kind][detection] += 1;
            if detection > 0 {
                let detected_by = ["", "comparing", "not"][detection];
                undetected.push((
                    tool.model.name.clone(),
                    KINDS[mutant.kind],
                    mutant.location,
                    detected_by,
                ));
            }
        }
        writeln!(body, "| {} | {} |", tool.model.name, row(&counts))?;
        for (sum, count) in totals.iter_mut().zip(counts) {
            *sum += count;
        }
    }
    writeln!(body, "| **all** | {} |", row(&totals))?;
    let different = totals[0] - totals[1];
    let percent = |count: usize| 100.0 * count as f64 / different as f64;
    writeln!(
        body,
        "\nOf {different}, {:.1} % are seen by errors or warnings ({:.1} % errors, {:.1} % open proofs, {:.1} % other warnings), {:.1} % \
         only by comparing, {:.1} % not.\n",
        percent(totals[2] + totals[3] + totals[4]),
        percent(totals[2]),
        percent(totals[3]),
        percent(totals[4]),
        percent(totals[5]),
        percent(totals[6])
    )?;
    writeln!(body, "| broken | error or warning | comparing | not |\n|---|--:|--:|--:|")?;
    for (kind, counts) in KINDS.iter().zip(by_kind) {
        writeln!(body, "| {kind} | {} |", row(&counts))?;
    }
    if !undetected.is_empty() {
        writeln!(
            body,
            "\n### No error and no warning\n\n| tool | what | where | seen |\n|---|---|---|---|"
        )?;
        for (name, kind, place, detected_by) in undetected {
            writeln!(body, "| {name} | {kind} | {place} | {detected_by} |")?;
        }
    }
    Ok(Section { title: "Broken on purpose", body, missed_limits: Vec::new() })
}

fn row(counts: &[usize]) -> String {
    counts.iter().map(usize::to_string).collect::<Vec<_>>().join(" | ")
}
