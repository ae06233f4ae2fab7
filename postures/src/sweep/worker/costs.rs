//! A measurement: which share of a sweep's time goes into the postures that it refuses and into those that it accepts.
//! A faster way to decide them saves no more than that.
//!
//! ```sh
//! PARTS=part.stl:mm,other.ply:inch cargo test --release -p touchoff-postures --lib costs -- --ignored --nocapture
//! ```

use super::*;
use crate::{Directions, Rules};
use std::num::NonZeroU16;
use std::time::{Duration, Instant};
use touchoff::certify::TriangleBvh;
use touchoff::mesh::{Geometry, shapes};
use touchoff::{Mesh, Unit};

/// Batches of a part that are measured, evenly among all.
const BATCHES: usize = 12;

const HEADER: &str = "
| part | tool | ns per posture | known obstructions | found obstructions | acceptable | rest | at most, refusing for nothing | and accepting |
|---|---|--:|--:|--:|--:|--:|--:|--:|";

#[test]
#[ignore = "a measurement"]
fn costs() {
    let tube = shapes::tube(12.0, 25.0, 40.0, 96, 24, Unit::Millimetre).expect("a tube");
    let mut parts = vec![("tube".to_owned(), tube)];
    let named = std::env::var("PARTS").unwrap_or_default();
    for part in named.split(',').filter(|part| !part.is_empty()) {
        let (file, unit) = part.rsplit_once(':').expect("a file and its unit, as in part.stl:mm");
        let Ok(Geometry::Mesh(mesh)) = Geometry::read(file, unit.parse().expect("a unit")) else {
            panic!("{file} is no mesh that can be read")
        };
        let name = file.rsplit('/').next().unwrap_or(file);
        parts.push((name.to_owned(), mesh));
    }
    let tools: [&dyn Tool; 4] = [
        &touchoff_tools::D2Ball,
        &touchoff_tools::BallEr16,
        &touchoff_tools::Flat,
        &touchoff_tools::BullNose,
    ];
    println!("{HEADER}");
    for (part, mesh) in &parts {
        for tool in tools {
            let Costs { postures, total, known, found, acceptable } = Costs::measure(mesh, tool);
            let share = |time: Duration| time.as_secs_f64() / total.as_secs_f64();
            let decided = known + found + acceptable;
            let shares = [known, found, acceptable, total - decided]
                .map(|time| format!("{:.0} %", 100.0 * share(time)))
                .join(" | ");
            println!(
                "| {part} | {} | {:.0} | {shares} | {:.2} | {:.1} |",
                tool.info().name,
                total.as_nanos() as f64 / postures as f64,
                1.0 / (1.0 - share(known + found)),
                1.0 / (1.0 - share(decided)),
            );
        }
    }
}

/// Times of all postures of some triangles, on one core.
#[derive(Default)]
struct Costs {
    postures: usize,
    /// Time of the whole sweep.
    total: Duration,
    /// Time of the postures that a known obstruction refuses. This and the next two are without the time of reading the clock.
    known: Duration,
    /// Time of those that a search refuses.
    found: Duration,
    /// Time of those that are accepted.
    acceptable: Duration,
}

impl Costs {
    fn measure(mesh: &Mesh, tool: &dyn Tool) -> Costs {
        let bvh = TriangleBvh::new(mesh);
        let directions = Directions::spread(100);
        let rules = Rules {
            tolerance: Rules::default_tolerance(mesh.unit()),
            niceness: 0.0,
            allowed: Vec::new(),
        };
        let keep = NonZeroU16::MIN;
        let sweep = PostureSweep::new(mesh, &bvh, vec![tool], &directions, rules, keep)
            .expect("a tool that cuts");
        let mut worker = Worker::new(&sweep).expect("a tool that cuts");
        let mut costs = Costs::default();
        let clock = reading_the_clock();
        for batch in (0..sweep.batches()).step_by((sweep.batches() / BATCHES).max(1)) {
            let pieces = || sweep.triangles(batch).iter().map(|id| Piece::whole(*id));
            let start = Instant::now();
            worker.rows(pieces());
            costs.total += start.elapsed();
            costs.postures += pieces().len() * directions.list().len();
            let candidate = &mut worker.tools[0];
            candidate.clear_caches();
            pieces().filter_map(|piece| surface_point(mesh, piece)).for_each(|point| {
                costs.add(candidate, &sweep, point, clock);
            });
        }
        costs
    }

    /// Decides the postures at a point again, and adds the time of each.
    fn add<'a>(
        &mut self,
        candidate: &mut CandidateTool<'a>,
        sweep: &PostureSweep<'a>,
        point: SurfacePoint,
        clock: Duration,
    ) {
        let axes = sweep.directions.list().iter().map(|axis| Vector3::from(*axis));
        let (mut postures, mut location) = (Vec::new(), None);
        candidate.placement.list(point, axes, &mut postures);
        for contacts in postures.chunk_by(|a, b| a.direction == b.direction) {
            for posture in contacts.iter().filter(|contact| contact.niceness > 0.0) {
                let start = Instant::now();
                let decision = candidate.decide(sweep, posture, point, &mut location);
                let time = start.elapsed().saturating_sub(clock);
                match decision {
                    PostureDecision::CachedObstruction => self.known += time,
                    PostureDecision::Obstructed => self.found += time,
                    PostureDecision::Acceptable => {
                        self.acceptable += time;
                        break;
                    }
                    PostureDecision::Undecided | PostureDecision::BelowNiceness => {}
                }
            }
        }
    }
}

/// Returns the time that reading the clock takes.
fn reading_the_clock() -> Duration {
    const READINGS: u32 = 100_000;
    let start = Instant::now();
    for _ in 0..READINGS {
        std::hint::black_box(Instant::now());
    }
    start.elapsed() / READINGS
}
