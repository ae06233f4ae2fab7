//! Certified ways beside samples of them.
//!
//! What is proved is that no triangle comes deeper into a tool than its tolerance. Samples
//! ([`super::approach`]) know the tool from its restatement and the way from a formula of their own.

use super::approach::{Closest, Way};
use super::brute::{Brute, distance, nearest};
use super::{Pair, Worst, ways};
use nalgebra::Point3;
use std::fmt::Write;
use touchoff::certify::{Certifier, Sweep, Witness};
use touchoff::{Mesh, Motion};
use touchoff_tests::oracle::Oracle;
use touchoff_tests::oracle::draw::Draw;

/// The tolerances that are asked for, in the part's unit.
const TOLERANCES: [f64; 3] = [0.0, 1e-6, 1e-3];

/// Times of a way that are sampled.
const TIMES: u32 = 64;

/// How many ways are drawn for one that is proved, at most.
const TRIES: usize = 20;

/// How many that are not decided are told.
const TOLD: usize = 24;

/// What a tool and a part give.
#[derive(Clone, Debug)]
pub struct Row {
    /// The tool.
    pub tool: String,
    /// The part.
    pub part: String,
    /// Ways that were asked about.
    pub motions: usize,
    /// Those that were proved.
    pub proved: usize,
    /// Those with a witness.
    pub touching: usize,
    /// Those that are not decided, and how to see them again.
    pub undecided: Vec<String>,
    /// Those that were proved and come nearer than 0.001.
    pub near: usize,
    /// How much deeper than the tolerance a sample is. More than rounding is a violation.
    pub over: Worst,
    /// How far the tip and the axis are from where another formula has them. More than rounding is a violation.
    pub off: Worst,
    /// Everything that must not happen.
    pub violations: Vec<String>,
}

impl Pair<'_> {
    /// Asks about ways until so many are proved.
    ///
    /// # Panics
    /// If the tool is refused.
    pub fn sweeps(&self, count: usize, seed: u64) -> Row {
        let mut draw = Draw::new(seed);
        let card = self.tool.card();
        let brute = Brute::new(self.mesh, self.oracle, card.unit.to(self.mesh.unit()));
        let mut certifier = Certifier::new(self.facets, self.tool).expect("a tool with a profile");
        let mut row = Row {
            tool: card.name.to_string(),
            part: self.part.to_owned(),
            motions: 0,
            proved: 0,
            touching: 0,
            undecided: Vec::new(),
            near: 0,
            over: Worst { by: f64::NEG_INFINITY, at: String::new() },
            off: Worst::default(),
            violations: Vec::new(),
        };
        while row.proved < count && row.motions < TRIES * count {
            let kind = ways::KINDS[row.motions % ways::KINDS.len()];
            let tolerance = TOLERANCES[row.motions % TOLERANCES.len()];
            let way = ways::way(&brute, kind, &mut draw);
            let motion = Motion::new(&way.from, &way.to).expect("axes that are not opposite");
            let swept = certifier.sweep_clear(&motion, tolerance);
            let at = format!(
                "{} in {} ({kind}) from {} to {}, tolerance {tolerance:e}: {swept:?}",
                row.tool,
                row.part,
                told(&way.from),
                told(&way.to),
            );
            row.motions += 1;
            let mut judge = Judge {
                pair: self,
                brute: &brute,
                way,
                motion,
                // Places are proved to so much, and samples err by as much.
                rounding: 64.0 * f64::EPSILON * (brute.size + motion.way().norm()),
                tolerance,
                row: &mut row,
                at,
            };
            judge.judge(swept, &mut draw);
        }
        row
    }
}

fn told(pose: &touchoff::Pose) -> String {
    format!("tip {:?} axis {:?}", pose.tip().coords.as_slice(), pose.axis().as_slice())
}

struct Judge<'a> {
    pair: &'a Pair<'a>,
    brute: &'a Brute<'a>,
    way: Way,
    motion: Motion,
    rounding: f64,
    tolerance: f64,
    row: &'a mut Row,
    at: String,
}

impl Judge<'_> {
    fn judge(&mut self, swept: Sweep, draw: &mut Draw) {
        for t in [0.0, 1.0, draw.between(0.0, 1.0)] {
            self.same(t);
        }
        match swept {
            Sweep::Clear | Sweep::Inside(_) | Sweep::SurfaceOnly => {
                self.row.proved += 1;
                let closest = self.brute.closest(&self.way, TIMES, true, draw);
                self.proved(&closest);
                self.side(swept);
            }
            Sweep::Touching(t, witness) => {
                self.row.touching += 1;
                self.same(t);
                self.witness(t, &witness);
            }
            Sweep::Undecided(t) => self.undecided(t, draw),
        }
    }

    /// What comes before is proved.
    fn undecided(&mut self, t: f64, draw: &mut Draw) {
        let closest = self.brute.closest(&self.way, TIMES, true, draw);
        self.row.undecided.push(format!("{}, {closest:?}", self.at));
        if !(0.0..=1.0).contains(&t) {
            self.wrong("undecided at no time");
        } else if t > 0.0 {
            let until = Way { from: self.way.from, to: self.way.pose(t) };
            let closest = self.brute.closest(&until, TIMES, true, draw);
            self.proved(&closest);
        }
    }

    fn proved(&mut self, closest: &Closest) {
        let allowed = self.tolerance.max(16.0 * self.rounding) + self.rounding;
        let over = closest.depth - allowed;
        self.row.near += usize::from(closest.depth > -1e-3);
        self.row.over.see(over, || format!("{}, {closest:?}", self.at));
        if over > 0.0 {
            self.wrong(&format!("it is proved, but {closest:?}"));
        }
    }

    /// Whether a motion has the tip and the axis where they should be.
    fn same(&mut self, t: f64) {
        let (pose, own) = (self.motion.pose(t), self.way.pose(t));
        let tip = (pose.tip() - own.tip()).norm() - self.rounding;
        // The formula divides by the sine.
        let sine = self.way.angle().sin();
        let known = 16.0 * f64::EPSILON / if sine > 0.0 { sine.min(1.0) } else { 1.0 };
        let off = tip.max((pose.axis() - own.axis()).norm() - known.min(1e-13));
        let text = || format!("{}, at {t:?}", self.at);
        self.row.off.see(off, text);
        if off > 0.0 || !(0.0..=1.0).contains(&t) {
            self.wrong(&format!("the pose is off by {off:e} at {t:?}"));
        }
    }

    fn witness(&mut self, t: f64, witness: &Witness) {
        let (brute, pose) = (self.brute, self.motion.pose(t));
        let point = brute.inside(&pose, witness.point);
        let depth = brute.depth(point) * brute.length;
        if depth < -self.rounding {
            self.wrong(&format!("the witness is {depth:e} deep"));
        }
        let triangle = brute.triangle(&brute.seen(&pose), witness.triangle as usize);
        let off = distance(point, nearest(point, &triangle)) * brute.length;
        if off > self.rounding {
            self.wrong(&format!("the witness is {off:e} from its triangle"));
        }
        let surfaces = &self.pair.tool.card().surfaces;
        let away = surfaces[witness.surface..=witness.surface]
            .iter()
            .map(|surface| self.pair.oracle.away(&surface.name, point));
        let away = away.fold(f64::INFINITY, f64::min) * brute.length;
        if away > depth.abs() + self.rounding {
            self.wrong(&format!("its surface is {away:e} away, but it is {depth:e} deep"));
        }
    }

    /// Inside or outside, by the angle that the part is seen under from the tool.
    fn side(&mut self, swept: Sweep) {
        let [_, height] = self.pair.oracle.extent();
        let top = self.way.from.tip() + self.way.from.axis() * (0.9 * height * self.brute.length);
        let inside = turns(self.pair.mesh, top).round() > 0.0;
        if matches!((swept, inside), (Sweep::Clear, true) | (Sweep::Inside(_), false)) {
            self.wrong("it is on the other side");
        }
    }

    fn wrong(&mut self, what: &str) {
        self.row.violations.push(format!("{what}: {}", self.at));
    }
}

/// How often a surface goes around a point: the sum of the angles of its triangles (Van Oosterom, Strackee 1983).
fn turns(mesh: &Mesh, point: Point3<f64>) -> f64 {
    let angle = |id: u32| {
        let [a, b, c] = mesh.triangle(id).map(|corner| corner - point);
        let (x, y, z) = (a.norm(), b.norm(), c.norm());
        let whole = x * y * z + a.dot(&b) * z + b.dot(&c) * x + c.dot(&a) * y;
        2.0 * a.dot(&b.cross(&c)).atan2(whole)
    };
    let all: f64 = (0..mesh.triangles().len() as u32).map(angle).sum();
    all / (4.0 * std::f64::consts::PI)
}

/// The rows as Markdown, and under them what is not decided and what was violated.
///
/// # Errors
/// None that a text could have.
pub fn table(rows: &[Row]) -> Result<String, std::fmt::Error> {
    let mut page = "| tool | part | motions | proved | of these near | touching | undecided | worst over | violations |\n\
                    |---|---|--:|--:|--:|--:|--:|--:|--:|\n"
        .to_owned();
    for row in rows {
        writeln!(
            page,
            "| {} | {} | {} | {} | {} | {} | {} | {:.1e} | {} |",
            row.tool,
            row.part,
            row.motions,
            row.proved,
            row.near,
            row.touching,
            row.undecided.len(),
            row.over.by,
            row.violations.len()
        )?;
    }
    let sum = |of: fn(&Row) -> usize| rows.iter().map(of).sum::<usize>();
    writeln!(
        page,
        "\n{} motions, {} of them proved, {} touching, {} undecided.",
        sum(|row| row.motions),
        sum(|row| row.proved),
        sum(|row| row.touching),
        sum(|row| row.undecided.len())
    )?;
    list(&mut page, "Undecided", rows.iter().flat_map(|row| &row.undecided).take(TOLD))?;
    list(&mut page, "Violated", rows.iter().flat_map(|row| &row.violations))?;
    Ok(page)
}

fn list<'a>(
    page: &mut String,
    title: &str,
    lines: impl Iterator<Item = &'a String>,
) -> std::fmt::Result {
    writeln!(page, "\n## {title}\n")?;
    let mut lines = lines.peekable();
    if lines.peek().is_none() {
        writeln!(page, "Nothing.")?;
    }
    for line in lines {
        writeln!(page, "- {line}")?;
    }
    Ok(())
}
