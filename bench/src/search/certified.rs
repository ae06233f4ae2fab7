//! Depths of triangles beside what `Certifier` proves of them.

use super::clouds::{climbed, depth, sheet};
use super::poses::{Numbers, numbers, pose, told};
use super::{Answer, Climb, Effort, Find, Question, neighbours};
use crate::certified::brute::Brute;
use crate::certified::poses;
use nalgebra::Point3;
use touchoff::certify::{Certifier, Clear, Facets};
use touchoff::{Mesh, Pose, Tool, Unit};
use touchoff_tests::oracle::Nearest;
use touchoff_tests::oracle::draw::Draw;
use touchoff_tests::oracle::reference::Reference;

/// Units of roundoff of all sizes together that places are known by.
const ROUNDING: f64 = 64.0;

/// The deepest of the triangles at a pose: brute force, and from there a climb of the places of one triangle judged by 256 bits.
fn deepest(
    brute: &Brute<'_>,
    (mesh, reference): (&Mesh, &Reference),
    pose: &Pose,
    found: Option<(u32, Point3<f64>)>,
    steps: usize,
    draw: &mut Draw,
) -> f64 {
    // What doubles say is not taken at their word.
    let rough = brute.deepest(&brute.seen(pose), draw, &mut 0) - 16.0 * f64::EPSILON * brute.size;
    let Some((triangle, point)) = found else { return rough };
    let corners = mesh.triangle(triangle);
    let place = |[v, w]: [f64; 2]| -> Option<Point3<f64>> {
        let inside = v >= 0.0 && w >= 0.0 && v + w <= 1.0;
        inside.then(|| corners[0] + v * (corners[1] - corners[0]) + w * (corners[2] - corners[0]))
    };
    // The place is rounded once in the world and once in the tool's frame.
    let frame = 2.0 * f64::EPSILON * brute.size;
    let start = barycentric(&corners, &point);
    let climb = Climb { steps, reach: 0.01 };
    let best = climb.from(start, draw, |at| {
        place(at).map_or(f64::NEG_INFINITY, |p| depth(reference, pose, &p, brute.length) - frame)
    });
    rough.max(best.value)
}

fn barycentric(corners: &[Point3<f64>; 3], point: &Point3<f64>) -> [f64; 2] {
    let [e, f] = [corners[1] - corners[0], corners[2] - corners[0]];
    let off = point - corners[0];
    let [ee, ef, ff] = [e.dot(&e), e.dot(&f), f.dot(&f)];
    let det = ee * ff - ef * ef;
    let (oe, of) = (off.dot(&e), off.dot(&f));
    let v = ((ff * oe - ef * of) / det).clamp(0.0, 1.0);
    [v, ((ee * of - ef * oe) / det).clamp(0.0, 1.0 - v)]
}

/// The worst of `deepest` and of `clear`.
pub fn hunt(
    tool: &dyn Tool,
    (oracle, reference): (&Nearest, &Reference),
    effort: Effort,
    draw: &mut Draw,
) -> Vec<Answer> {
    let mesh = sheet(tool, 0.0);
    let facets = Facets::new(&mesh);
    let Ok(mut certifier) = Certifier::new(&facets, tool) else { return Vec::new() };
    // A tool that is known by its field takes thousands of times as long.
    let first = &tool.card().surfaces[0].name;
    let field = Certifier::new(&facets, tool).is_ok_and(|c| c.allow(first, 0.0).is_err());
    let (budget, steps) = if field { (1 << 9, effort.steps / 8) } else { (1 << 20, effort.steps) };
    certifier = certifier.budget(budget);
    let length = tool.card().unit.to(Unit::Millimetre);
    let brute = Brute::new(&mesh, oracle, length);
    let rounding = ROUNDING * f64::EPSILON * brute.size;
    let empty = |question| Answer {
        question,
        find: Find::default(),
        seeds: f64::NEG_INFINITY,
        bar: Some(0.0),
    };
    let (mut over, mut cleared) = (empty(Question::Certified), empty(Question::Cleared));
    over.find.error = f64::NEG_INFINITY;
    let mut inner = draw.clone();
    let value = |numbers: Numbers| {
        let Some(pose) = pose(numbers) else { return f64::NEG_INFINITY };
        let found = certifier.deepest(&pose, 0.0);
        let Some(witness) = found.witness else { return f64::NEG_INFINITY };
        let place = Some((witness.triangle, witness.point));
        let most = deepest(&brute, (&mesh, reference), &pose, place, 24, &mut inner);
        let witness =
            depth(reference, &pose, &witness.point, length) + 2.0 * f64::EPSILON * brute.size;
        (most - found.depth[1]).max(found.depth[0] - witness) / rounding
    };
    let about = (&mesh, oracle, length);
    climbed(&mut over, value, "sheet", about, steps / 24, draw);

    cleared.find.error = f64::NEG_INFINITY;
    for _ in 0..steps / 8 {
        let start = numbers(&poses::pose(&mesh, oracle, length, draw));
        // Away from the sheet, whose normals go up.
        let reach = 3.0 * reference.scale() * length;
        let [x, y, z] = draw.direction();
        let way = [0.3 * x, 0.3 * y, 1.0 + 0.3 * z, 0.0, 0.0, 0.0];
        let to: Numbers = std::array::from_fn(|k| start[k] + reach * way[k]);
        let clear = |numbers: &Numbers, certifier: &mut Certifier<'_>| {
            let pose = pose(*numbers);
            pose.is_some_and(|pose| {
                matches!(certifier.clear(&pose), Clear::Clear | Clear::SurfaceOnly)
            })
        };
        let pair = neighbours(start, to, |numbers| clear(numbers, &mut certifier));
        let last = pair.and_then(|pair| pair.into_iter().find(|n| clear(n, &mut certifier)));
        let Some(last) = last else { continue };
        let Some(pose) = pose(last) else { continue };
        let place = certifier.clearance(&pose, 0.0).witness;
        let place = place.map(|witness| (witness.triangle, witness.point));
        let most = deepest(&brute, (&mesh, reference), &pose, place, 48, draw) / rounding;
        cleared.seeds = cleared.seeds.max(most);
        cleared.find.see(most, || (format!("sheet, {}", told(last)), Vec::new()));
    }
    vec![over, cleared]
}
