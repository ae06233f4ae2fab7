//! The section of `certified.md` on the 256-bit reference, where rounding errors are largest.

use std::error::Error;
use touchoff_bench::page::Section;
use touchoff_bench::parallel;
use touchoff_bench::rounding::cases::Family;
use touchoff_bench::rounding::{RoundingCheck as Cases, Row, table};

/// Number of cases that a thread takes at once.
const CHUNK: u64 = 2000;

/// Returns the section about `count` cases of all families together.
pub(super) fn section(count: u64, seed: u64) -> Result<Section, Box<dyn Error>> {
    let rows = rows(&Cases::new(seed), count)?;
    let about = "\
Each case is a triangle, or a few, a tool and a pose, drawn where rounding does the most: eleven profiles at five scales from 1e-6 to 1e6 mm, tolerances 0 and
1e-9 of the tool's size. The doubles of the mesh and the pose are exact numbers, and a place `p` of the part is `R⁻¹ (p - tip)` in the tool's frame, as `Pose` says.
A search in doubles finds places; the depth of the best of them in 256 bits is less than the true greatest depth or equal. The upper end is
*exceeded* if it is below that. A witness is *off* if it is farther from its triangle than the promised widening and the rounding of a point of the world, and
*shallow* if the place of the triangle next to it is less deep than the lower end by more than the two are apart and that rounding: both are violations for certain.

*Found alone* counts cases in which the search comes within 1e-9 of the tool's size of the lower end without knowing the witness, *low certain* those whose lower
end is no more than a depth in 256 bits. The widening is 64 ε of the tool's and the part's size together, and the skew; the lower end has the 64 ε twice. *Above* is the largest part that the truth
takes of what the upper end adds to the depth that was computed and the tolerance, *below* of what the lower end takes from that depth; at 1 the end would be
wrong. *Wider* counts intervals wider than the tolerance, or four roundings if that is more, and both widenings by a hundredth of one; *widest* is by how many
widenings at most. `--case` and its number show a case.

All rotations that the public interface of `Pose` makes are orthonormal to 4 ε: axes and quaternions are normalised if their norm is within 1e-3 of 1, and
composed rotations are corrected. *Drift* has some composed of up to 24 others.

";
    Ok(Section {
        title: "Beside 256 bits",
        body: about.to_owned() + &table(&rows)?,
        missed_limits: rows
            .iter()
            .filter(|row| row.violations() > 0)
            .map(describe_violations)
            .collect(),
    })
}

/// Prints the case with this number.
pub(super) fn show(number: u64, seed: u64) -> Result<(), Box<dyn Error>> {
    let cases = Cases::new(seed);
    let mut rows = Family::ALL.map(Row::new).to_vec();
    cases.run_case(number, &mut rows);
    rows.retain(|row| row.cases > 0);
    println!("{}\n{}", cases.describe(number), table(&rows)?);
    Ok(())
}

/// Returns a description of the violations of a family.
fn describe_violations(row: &Row) -> String {
    let Row { family, upper_violations, off_triangle, too_shallow, .. } = row;
    format!(
        "{family:?}: {upper_violations} upper ends exceeded, {off_triangle} witnesses off their triangles, {too_shallow} shallow"
    )
}

/// Returns one row per family.
fn rows(cases: &Cases, count: u64) -> Result<Vec<Row>, std::num::TryFromIntError> {
    let chunks = usize::try_from(count.div_ceil(CHUNK))?;
    let chunk_rows = parallel::rows(chunks, |k| {
        let from = k as u64 * CHUNK;
        let mut chunk_rows = Family::ALL.map(Row::new);
        for number in from..(from + CHUNK).min(count) {
            cases.run_case(number, &mut chunk_rows);
        }
        chunk_rows.iter().flat_map(|row| &row.descriptions).for_each(|text| eprintln!("{text}"));
        chunk_rows
    });
    let mut rows = Family::ALL.map(Row::new).to_vec();
    for chunk in chunk_rows {
        for (row, part_of_row) in rows.iter_mut().zip(chunk) {
            row.add(part_of_row);
        }
    }
    Ok(rows)
}
