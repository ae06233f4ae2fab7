//! Item 8: grazing contacts, with depths of 1e-1 to 1e-15, on a plane, on a sphere and in a bore.
//!
//! The deepest point of the part is a point of the cloud at the world's origin. Its depth follows from the pose alone.

use super::ledger::{Kind, Ledger};
use super::scene::{Asked, Given, shown};
use super::truth::Subject;
use nalgebra::{Point3, Vector3};
use std::f64::consts::{PI, TAU};
use touchoff::certify::{Certifier, TriangleBvh};
use touchoff::mesh::shapes;
use touchoff::{Interval, Mesh, Pose, Probe, TriangleId};
use touchoff_tests::oracle::big::Big;
use touchoff_tests::oracle::draw::Rng;
use touchoff_tests::oracle::restated;

/// Error of the greatest depth relative to the closed form.
const CLOSED: Kind = Kind::of("closed form", "Probe::rounding_error_bound", 1.0);
/// A contact deeper than the error bound that was not found.
const MISSED: Kind = Kind::never("contact missed");
/// Distance of the closed form from the certified interval.
const CERTIFIED: Kind = Kind::of("outside the certified interval", "64 ε (tool + part)", 1.0);
/// Width of the certified interval beyond 1e-9.
const WIDE: Kind = Kind::of("its width beyond 1e-9 mm", "256 ε (tool + part)", 1.0);
/// Width of the interval for a tool without a profile. The certifier knows its depth only by a bound on its change and
/// stops when the budget is spent, so the interval is valid but wide.
const WIDTH: Kind =
    Kind::told("its width, of tools whose distance it does not know", "of the tool's unit");
/// Maximum number of nodes per query for such a tool.
const BUDGET: u32 = 20_000;

/// A side of the tool: its radius, the height of its middle, and its length.
type Side = [f64; 3];

/// Returns the longest line of a tool's profile that is parallel to the axis, or a ball's equator. Returns `None` for a
/// solid.
fn side(subject: &Subject) -> Option<Side> {
    match subject.name() {
        "UnitSphere" => return Some([1.0, 1.0, 1.0]),
        "Fig73" => return Some([1.0, 3.0, 4.0]),
        _ => {}
    }
    let tool = restated::of(subject.name())?;
    let mut from = tool.start;
    let mut longest: Option<Side> = None;
    for way in tool.ways {
        let [d, low, high] = [&way.to[0], &from[1], &way.to[1]].map(Big::to_f64);
        if way.centre.is_none() && from[0] == way.to[0] && high > low {
            let this = [d, (low + high) / 2.0, high - low];
            longest = longest.filter(|other| other[2] >= this[2]).or(Some(this));
        }
        from = way.to;
    }
    longest
}

/// Returns the depth to which a tool can be pressed into a plane such that its end is the surface nearest to the point
/// on its axis: half the radius of its end face or ball. Returns 0 for a tool whose end is neither.
fn stands(subject: &Subject) -> f64 {
    let Some(tool) = restated::of(subject.name()) else { return 0.5 };
    let (zero, first) = (Big::zero(), &tool.ways[0]);
    let level = first.centre.is_none() && first.to[1] == zero && tool.start[1] == zero;
    let ball = first.centre.as_ref().is_some_and(|centre| centre[0] == zero);
    if level || ball { 0.5 * first.to[0].to_f64() } else { 0.0 }
}

/// Returns whether a tool has a profile, so that the certifier knows its distance.
fn known(subject: &Subject) -> bool {
    !subject.tool.info().outline.is_empty()
}

/// Returns points of a surface: the origin, then `count` points that `at` returns for numbers between -1 and 1.
fn surface(
    subject: &Subject,
    count: usize,
    draw: &mut Rng,
    at: impl Fn([f64; 2]) -> Point3<f64>,
) -> Given {
    let mut given = Given {
        points: vec![Point3::origin()],
        normals: Vec::new(),
        weights: vec![1.0; count + 1],
        unit: subject.tool.info().unit,
    };
    let mut any = || {
        let near = 10f64.powf(draw.between(-8.0, 0.0));
        [0; 2].map(|_| near * draw.between(-1.0, 1.0))
    };
    given.points.extend((0..count).map(|_| at(any())));
    given.normals = vec![Vector3::z(); count + 1];
    given
}

/// Presses a tool into a plane, a sphere and a bore.
pub(super) fn tangent(subject: &Subject, count: usize, draw: &mut Rng, ledger: &mut Ledger) {
    let size = subject.oracle.extent()[0].min(5.0);
    let depths = (1..=15).map(|k| 10f64.powi(-k) * size.min(1.0));
    let plane = surface(subject, count, draw, |[a, b]| Point3::new(a * size, b * size, 0.0));
    let side = side(subject);
    let round = side.map_or(size, |[.., long]| (long / 3.0).min(2.0 * size));
    let pole = Point3::origin();
    let sphere = surface(subject, count, draw, |[a, b]| {
        let (across, turn) = (a * PI / 2.0, b * PI);
        let out = round * across.sin();
        let along = round * 2.0 * (across / 2.0).sin().powi(2);
        pole + Vector3::new(along, out * turn.cos(), out * turn.sin())
    });
    let bore = side.map(|[radius, ..]| {
        let wide = radius + 0.1 * size;
        surface(subject, count, draw, |[a, b]| {
            let turn = a * PI;
            let back = wide * 2.0 * (turn / 2.0).sin().powi(2);
            Point3::new(-back, wide * turn.sin(), 0.02 * size * b)
        })
    });
    for depth in depths {
        let (tip, level) = (Point3::new(0.0, 0.0, -depth), Big::exactly(depth));
        let closed = (depth <= stands(subject)).then_some(&level);
        pressed(subject, (&plane, tip), closed, ledger);
        let Some([radius, height, _]) = side else { continue };
        let off = radius - depth;
        let tip = Point3::new(-off, 0.0, -height);
        // The depth after the tip was rounded.
        let left = &Big::decimal(radius) - &Big::exactly(off);
        for given in [Some(&sphere), bore.as_ref()].into_iter().flatten() {
            pressed(subject, (given, tip), Some(&left), ledger);
        }
    }
    certified(subject, side, [size, round], ledger);
}

fn pressed(
    subject: &Subject,
    (given, tip): (&Given, Point3<f64>),
    closed: Option<&Big>,
    ledger: &mut Ledger,
) {
    let pose = Pose::from_quaternion(tip, [0.0, 0.0, 0.0, 1.0]).expect("a unit quaternion");
    let part = given.part();
    let (tool, truth) = (subject.tool, &*subject.truth);
    let (contacts, _) = Asked { tool, truth, given, part: &part }.at(&pose, ledger);
    let Some(closed) = closed else { return };
    let error = Probe::new(&part, tool).rounding_error_bound().expect("proved of every tool");
    let first = contacts.iter().find(|contact| contact.triangle == TriangleId(0));
    let deep = closed.to_f64();
    match first {
        Some(first) => {
            let off = (&Big::exactly(first.depth) - closed).abs().to_f64();
            ledger.see(CLOSED, off / error, || shown(&pose));
        }
        None => ledger.count(MISSED, deep > error, || shown(&pose)),
    }
}

/// Returns a ball whose pole is at the origin and is a vertex of the mesh.
fn ball(radius: f64, subject: &Subject) -> Mesh {
    const RINGS: u32 = 6;
    const SIDES: u32 = 12;
    let mut vertices = vec![Point3::origin()];
    for ring in 1..RINGS {
        let across = PI * f64::from(ring) / f64::from(RINGS);
        for side in 0..SIDES {
            let turn = TAU * f64::from(side) / f64::from(SIDES);
            let along = radius * (1.0 - across.cos());
            let out = radius * across.sin();
            vertices.push(Point3::new(along, out * turn.cos(), out * turn.sin()));
        }
    }
    vertices.push(Point3::new(2.0 * radius, 0.0, 0.0));
    let at = |ring: u32, side: u32| 1 + (ring - 1) * SIDES + side % SIDES;
    let last = vertices.len() as u32 - 1;
    let mut triangles = Vec::new();
    for side in 0..SIDES {
        triangles.push([0, at(1, side), at(1, side + 1)]);
        triangles.push([last, at(RINGS - 1, side + 1), at(RINGS - 1, side)]);
        for ring in 1..RINGS - 1 {
            let [a, b] = [at(ring, side), at(ring, side + 1)];
            let [c, d] = [at(ring + 1, side + 1), at(ring + 1, side)];
            triangles.extend([[a, c, b], [a, d, c]]);
        }
    }
    Mesh::new(vertices, triangles, subject.tool.info().unit).expect("a ball")
}

/// Queries the certifier for the same contacts, with triangles.
fn certified(subject: &Subject, side: Option<Side>, [size, round]: [f64; 2], ledger: &mut Ledger) {
    const SEGMENTS: u32 = 32;
    let unit = subject.tool.info().unit;
    let plane = shapes::plane(2.0 * size, 4, unit).expect("a plane");
    let round = ball(round, subject);
    let ring = side.map(|[radius, ..]| {
        let wide = radius + 0.1 * size;
        let high = 0.04 * size;
        shapes::tube(wide, wide + size, high, SEGMENTS, 1, unit).expect("a ring")
    });
    for depth in (1..=15).map(|k| 10f64.powi(-k) * size.min(1.0)) {
        if depth <= stands(subject) {
            interval(subject, &plane, Point3::new(0.0, 0.0, -depth), depth, ledger);
        }
        let (Some([radius, height, _]), Some(ring)) = (side, &ring) else { continue };
        // The rounding here is smaller than the certifier's own error.
        let off = radius - depth;
        interval(subject, &round, Point3::new(-off, 0.0, -height), radius - off, ledger);
        let half = PI / f64::from(SEGMENTS);
        let facet = (radius + 0.1 * size) * half.cos();
        let out = facet - off;
        let tip = Point3::new(out * half.cos(), out * half.sin(), 0.02 * size - height);
        interval(subject, ring, tip, radius - off, ledger);
    }
}

fn interval(subject: &Subject, mesh: &Mesh, tip: Point3<f64>, depth: f64, ledger: &mut Ledger) {
    let bvh = TriangleBvh::new(mesh);
    let Ok(certifier) = Certifier::new(&bvh, subject.tool) else { return };
    let exact = known(subject);
    let mut certifier = if exact { certifier } else { certifier.with_budget(BUDGET) };
    let pose = Pose::from_quaternion(tip, [0.0, 0.0, 0.0, 1.0]).expect("a unit quaternion");
    let Interval { low, high } = certifier.deepest(&pose, 1e-9).depth;
    let reach = mesh.bounds().iter().map(|p| p.coords.amax()).fold(tip.coords.amax(), f64::max);
    // The error bound depends on the circles of arcs as on the tool itself.
    let circles = subject.tool.info().outline.iter().filter_map(|piece| piece.circle);
    let circles = circles.map(|circle| circle.centre[0].hypot(circle.centre[1]) + circle.radius);
    let unit = f64::EPSILON * (circles.fold(subject.scale(), f64::max) + reach);
    let off = (low - depth).max(depth - high).max(0.0);
    let place = || format!("depth {depth:e} in {low:e} to {high:e}, {}", shown(&pose));
    ledger.see(CERTIFIED, off / (64.0 * unit), place);
    if exact {
        ledger.see(WIDE, (high - low - 1e-9).max(0.0) / (256.0 * unit), place);
    } else {
        ledger.tell(WIDTH, 1, high - low, &place());
    }
}
