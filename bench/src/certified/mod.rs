//! Certified penetrations beside what brute force finds, pose by pose.
//!
//! What is certified is the depth of triangles in a tool. Brute force ([`brute`]) knows the tool from its
//! restatement, samples triangles and climbs from the deepest samples. Whatever it finds has to be below
//! the upper bound; the lower bound is proved by the witness, whose depth is asked of the same oracle.

pub mod approach;
pub mod brute;
pub mod buried;
pub mod owned;
pub mod poses;
pub mod subject;
pub mod sweeps;
pub mod ways;
pub mod zoomed;

use brute::{Brute, Seen};
use nalgebra::Point3;
use std::fmt::Write;
use touchoff::certify::{Certifier, Clear, Facets, Witness};
use touchoff::{Mesh, Pose, Tool};
use touchoff_tests::oracle::Nearest;
use touchoff_tests::oracle::draw::Draw;

/// The tolerances that are asked for, in the part's unit.
pub const TOLERANCES: [f64; 4] = [0.0, 1e-9, 1e-6, 1e-3];

/// The largest excess of one kind, and how to see it again.
#[derive(Clone, Debug, Default)]
pub struct Worst {
    /// By how much, in the part's unit.
    pub by: f64,
    /// Tool, part and pose, to the last bit.
    pub at: String,
}

impl Worst {
    fn see(&mut self, by: f64, at: impl FnOnce() -> String) {
        if by.is_nan() || by > self.by {
            *self = Worst { by, at: at() };
        }
    }
}

/// What a tool and a part give.
#[derive(Clone, Debug)]
pub struct Row {
    /// The tool.
    pub tool: String,
    /// The part.
    pub part: String,
    /// Poses that were asked about.
    pub poses: usize,
    /// Those at which something is inside the tool.
    pub touching: usize,
    /// Points that brute force asked the oracle about.
    pub samples: u64,
    /// By how much brute force is above the upper bound. More than rounding is a violation.
    pub over: Worst,
    /// By how much the lower bound is above the witness's depth. More than rounding is a violation.
    pub under: Worst,
    /// By how much the lower bound is above what brute force finds on its own: how strong that is.
    pub behind: Worst,
    /// At how many poses it finds the lower bound on its own, to 1e-6.
    pub reached: usize,
    /// By how much an interval is wider than the tolerance.
    pub wide: Worst,
    /// How many intervals are wider than tolerance and rounding.
    pub wider: usize,
    /// Answers of `clear` that are `Undecided`.
    pub undecided: usize,
    /// Everything that must not happen.
    pub violations: Vec<String>,
}

/// What is compared with what.
pub struct Pair<'a> {
    /// The part's name, for people.
    pub part: &'a str,
    /// The part.
    pub mesh: &'a Mesh,
    /// Its triangles in a tree.
    pub facets: &'a Facets,
    /// The tool.
    pub tool: &'a dyn Tool,
    /// What the oracle knows about the tool.
    pub oracle: &'a Nearest,
}

impl Pair<'_> {
    /// Asks about so many poses.
    ///
    /// # Panics
    /// If the tool is refused.
    pub fn measure(&self, count: usize, seed: u64) -> Row {
        let mut draw = Draw::new(seed);
        let card = self.tool.card();
        let length = card.unit.to(self.mesh.unit());
        let brute = Brute::new(self.mesh, self.oracle, length);
        let mut certifier = Certifier::new(self.facets, self.tool).expect("a tool with a profile");
        let mut row = Row {
            tool: card.name.to_string(),
            part: self.part.to_owned(),
            poses: count,
            touching: 0,
            samples: 0,
            over: Worst::default(),
            under: Worst::default(),
            behind: Worst::default(),
            reached: 0,
            wide: Worst::default(),
            wider: 0,
            undecided: 0,
            violations: Vec::new(),
        };
        for k in 0..count {
            let pose = poses::pose(self.mesh, self.oracle, length, &mut draw);
            let tolerance = TOLERANCES[k % TOLERANCES.len()];
            let mut judge = Judge {
                pair: self,
                brute: &brute,
                seen: brute.seen(&pose),
                // What the oracle and the place of a sample err by.
                rounding: 64.0 * f64::EPSILON * brute.size,
                pose,
                tolerance,
                row: &mut row,
            };
            judge.pose(&mut certifier, &mut draw);
        }
        row
    }
}

/// A pose that is looked at.
struct Judge<'a> {
    pair: &'a Pair<'a>,
    brute: &'a Brute<'a>,
    seen: Seen,
    rounding: f64,
    pose: Pose,
    tolerance: f64,
    row: &'a mut Row,
}

impl Judge<'_> {
    fn pose(&mut self, certifier: &mut Certifier<'_>, draw: &mut Draw) {
        let found = certifier.deepest(&self.pose, self.tolerance);
        let [low, high] = found.depth;
        let deep = self.brute.deepest(&self.seen, draw, &mut self.row.samples);
        let at = format!(
            "{} in {} at tip {:?} axis {:?}, tolerance {:e}: {:?}, brute force {deep:?}",
            self.row.tool,
            self.row.part,
            self.pose.tip().coords.as_slice(),
            self.pose.axis().as_slice(),
            self.tolerance,
            found
        );
        self.row.touching += usize::from(deep > 0.0);
        self.row.behind.see(low - deep.max(0.0), || at.clone());
        self.row.reached += usize::from(low - deep.max(0.0) <= 1e-6);
        let mut most = deep;
        match found.witness {
            Some(witness) => {
                let depth = self.witness(&witness, &at);
                self.row.under.see(low - depth, || at.clone());
                if low - depth > self.rounding {
                    self.wrong("the witness is not as deep as the lower bound", &at);
                }
                most = most.max(self.beside(&witness, draw));
            }
            None if low > 0.0 => self.wrong("a lower bound without a witness", &at),
            None => (),
        }
        self.row.over.see(most - high, || at.clone());
        if most > high + self.rounding {
            self.wrong(&format!("a sample is {most:e} deep, above the upper bound"), &at);
        }
        // Not `low <= high`, which holds for no NaN.
        if !(0.0 <= low && low <= high && high.is_finite()) {
            self.wrong("no interval", &at);
        }
        let wide = high - low - self.tolerance;
        self.row.wide.see(wide, || at.clone());
        // The error is twice at either end and four times in the tolerance.
        self.row.wider += usize::from(wide > 8.0 * self.rounding);
        let clear = certifier.clear(&self.pose);
        self.clear(clear, most, low, &format!("{at}, {clear:?}"));
    }

    fn clear(&mut self, clear: Clear, most: f64, low: f64, at: &str) {
        match clear {
            Clear::Clear | Clear::SurfaceOnly | Clear::Inside(_) => {
                if most > self.rounding || low > 0.0 {
                    self.wrong("said not to touch", at);
                }
            }
            Clear::Touching(witness) => {
                if self.witness(&witness, at) < -self.rounding {
                    self.wrong("the witness of a touch is outside", at);
                }
            }
            Clear::Undecided(high) => {
                self.row.undecided += 1;
                if most > high + self.rounding {
                    self.wrong("deeper than what is undecided", at);
                }
            }
        }
    }

    /// The depth of a witness, which has to lie on its triangle.
    fn witness(&mut self, witness: &Witness, at: &str) -> f64 {
        let triangle = self.brute.triangle(&self.seen, witness.triangle as usize);
        let point = self.brute.inside(&self.pose, witness.point);
        let off = brute::distance(point, brute::nearest(point, &triangle)) * self.brute.length;
        if off > self.rounding {
            self.wrong(&format!("the witness is {off:e} from its triangle"), at);
        }
        if witness.surface >= self.pair.tool.card().surfaces.len() {
            self.wrong("the witness is at no surface", at);
        }
        self.brute.depth(point) * self.brute.length
    }

    /// The deepest that a climb from a witness reaches.
    fn beside(&mut self, witness: &Witness, draw: &mut Draw) -> f64 {
        let from = self.brute.inside(&self.pose, Point3::from(witness.point.coords));
        let triangle = witness.triangle as usize;
        self.brute.climb(&self.seen, triangle, from, draw, &mut self.row.samples)
    }

    fn wrong(&mut self, what: &str, at: &str) {
        self.row.violations.push(format!("{what}: {at}"));
    }
}

/// The rows as Markdown, and under them what was violated.
///
/// # Errors
/// None that a text could have.
pub fn table(rows: &[Row]) -> Result<String, std::fmt::Error> {
    let mut page = "| tool | part | poses | in contact | worst over | worst under | brute behind | reached | over the tolerance | wider \
                    | undecided | violations |\n|---|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n"
        .to_owned();
    for row in rows {
        let [over, under, behind, wide] =
            [&row.over, &row.under, &row.behind, &row.wide].map(|worst| worst.by);
        writeln!(
            page,
            "| {} | {} | {} | {} | {over:.1e} | {under:.1e} | {behind:.1e} | {} | {wide:.1e} | {} | {} | {} |",
            row.tool,
            row.part,
            row.poses,
            row.touching,
            row.reached,
            row.wider,
            row.undecided,
            row.violations.len()
        )?;
    }
    let sum = |of: fn(&Row) -> u64| rows.iter().map(of).sum::<u64>();
    writeln!(
        page,
        "\n{} poses, {} of them in contact, {} samples of brute force.\n\n## Violated\n",
        sum(|row| row.poses as u64),
        sum(|row| row.touching as u64),
        sum(|row| row.samples)
    )?;
    let mut violated = rows.iter().flat_map(|row| &row.violations).peekable();
    if violated.peek().is_none() {
        page += "Nothing.\n";
    }
    for violation in violated {
        writeln!(page, "- {violation}")?;
    }
    Ok(page)
}
