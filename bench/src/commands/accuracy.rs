//! The page `accuracy.md`: compiled tools compared with a 256-bit reference.

use clap::Args;
use std::error::Error;
use std::fmt::Write;
use touchoff_bench::page::{GENERATED_CODE, Page, Section};
use touchoff_bench::parallel;
use touchoff_tests::accuracy::{Row, measure, tools};

/// Compares compiled tools with a 256-bit reference: depth, side, owner and direction.
#[derive(Args)]
pub(crate) struct Accuracy {
    /// Number of points per tool.
    #[arg(long, value_name = "N", default_value_t = 1_000_000)]
    points: usize,
}

impl Accuracy {
    pub(crate) fn run(&self) -> Result<Option<Page>, Box<dyn Error>> {
        let tools = tools();
        let mut rows = parallel::rows(tools.len(), |k| {
            let (tool, restated) = &tools[k];
            let row = measure(*tool, restated, self.points, 1);
            eprintln!("{}: {:?}", row.name, row.violations());
            row
        });
        rows.sort_by(|a, b| a.name.cmp(&b.name));
        let missed_limits: Vec<String> = rows
            .iter()
            .flat_map(|row| {
                row.violations().into_iter().map(|violation| format!("{}: {violation}", row.name))
            })
            .collect();
        Ok(Some(Page {
            name: "accuracy",
            title: "Rounding of the compiled tools",
            covers: &[GENERATED_CODE, "tools-library/tools", "runtime/src/tool"],
            sections: vec![Section {
                title: "",
                body: body(&rows, &missed_limits, self.points)?,
                missed_limits,
            }],
            figures: Vec::new(),
        }))
    }
}

fn body(rows: &[Row], missed: &[String], count: usize) -> Result<String, std::fmt::Error> {
    let mut page = format!(
        "Compiled evaluators against 256 bits: for each tool {count} points, half of them within 1e-6 of the surface or of a splitting
curve (as many within 1e-15 as within 1e-6 of it), the others anywhere in its box; besides these every vertex and centre with
its neighbours of one ulp, and the axis at d = 0, -0, 5e-324 and 2^-540. Both forms of the code are asked, for one point and
for lanes. The reference knows each profile from a restatement of its own and takes the nearest feature by trying those that
doubles leave within 1e-9 of the tool's size, in 256 bits throughout.

S is the next power of two above the largest coordinate, ε = 2^-52, ulp(S) = ε S, ρ the distance to the nearest point at which
the direction does not exist. A side is wrong, or an owner, only beyond 2 ulp(S). The bar: depth 1 ulp(S), no wrong side, no wrong
owner, ||u| - 1| 4 ε, u - u_exact 8 ε max(1, S/ρ), the same bits in both forms. `Fig73` is not here: its magnitudes are no
distances.

| tool | S | points | inside | depth, ulp(S) | at | wrong sides | wrong owners | \\|\\|u\\|-1\\|, ε | u over its bound | outside, ulp(S) | unlike bits |
|---|--:|--:|--:|--:|---|--:|--:|--:|--:|--:|--:|
"
    );
    for row in rows {
        let clearance = match &row.clearance.location {
            Some(_) => format!("{:.3}", row.clearance.error),
            None => "bound only".to_owned(),
        };
        writeln!(
            page,
            "| {} | {} {} | {} | {} | {:.3} | {} | {} | {} | {:.2} | {:.3} | {clearance} | {} |",
            row.name,
            row.scale,
            row.unit,
            row.points,
            row.inside,
            row.depth.error,
            row.depth.location_rounded(),
            row.wrong_sides.count,
            row.wrong_owners.count,
            row.length.error,
            row.direction.error,
            row.different_bits,
        )?;
    }
    page += "\n## Missed\n\n";
    if missed.is_empty() {
        page += "Nothing.\n";
    }
    for line in missed {
        writeln!(page, "- {line}")?;
    }
    Ok(page)
}
