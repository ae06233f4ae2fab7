//! Item 8: contacts that only just touch, of depth 1e-1 to 1e-15, on a plane, a sphere and in a bore.
//!
//! The place of the part that is deepest is a point of its own, at the world's origin; how deep it is follows from the pose alone.

use super::ledger::{Kind, Ledger};
use super::scene::{Asked, Given, shown};
use super::truth::Subject;
use nalgebra::{Point3, Vector3};
use std::f64::consts::{PI, TAU};
use touchoff::certify::{Certifier, Facets};
use touchoff::mesh::shapes;
use touchoff::{Mesh, Pose, Probe};
use touchoff_tests::oracle::big::Big;
use touchoff_tests::oracle::draw::Draw;
use touchoff_tests::oracle::restated;

/// The depth of the deepest place against the closed form.
const CLOSED: Kind = Kind::of("closed form", "Probe::error", 1.0);
/// A contact deeper than the error that is not felt.
const MISSED: Kind = Kind::never("contact missed");
/// How far the closed form is out of the certified interval.
const CERTIFIED: Kind = Kind::of("outside the certified interval", "64 ε (tool + part)", 1.0);
/// How wide that is beyond 1e-9.
const WIDE: Kind = Kind::of("its width beyond 1e-9 mm", "256 ε (tool + part)", 1.0);
/// Without a profile depth is known by how fast it changes, and looking is given up at some time: the interval
/// holds, but is wide.
const WIDTH: Kind =
    Kind::told("its width, of tools whose distance it does not know", "of the tool's unit");
/// So many nodes a question may look at then.
const BUDGET: u32 = 20_000;

/// A side of the tool: its radius, how high its middle is, and how long it is.
type Side = [f64; 3];

/// The longest upright line of a tool's profile; a ball's equator where it has none. `None` of a solid.
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

/// How deep a tool may be pressed into a plane and its middle be the nearest to its end: half as deep as its face or ball is wide. 0 of a
/// tool that does not stand on its middle.
fn stands(subject: &Subject) -> f64 {
    let Some(tool) = restated::of(subject.name()) else { return 0.5 };
    let (zero, first) = (Big::zero(), &tool.ways[0]);
    let level = first.centre.is_none() && first.to[1] == zero && tool.start[1] == zero;
    let ball = first.centre.as_ref().is_some_and(|centre| centre[0] == zero);
    if level || ball { 0.5 * first.to[0].to_f64() } else { 0.0 }
}

/// Whether a tool has a profile: then the certifier knows the distance.
fn known(subject: &Subject) -> bool {
    !subject.tool.card().outline.is_empty()
}

/// Points of a surface, the origin first, then where `at` says, for numbers between -1 and 1.
fn surface(
    subject: &Subject,
    count: usize,
    draw: &mut Draw,
    at: impl Fn([f64; 2]) -> Point3<f64>,
) -> Given {
    let mut given = Given {
        points: vec![Point3::origin()],
        normals: Vec::new(),
        weights: vec![1.0; count + 1],
        unit: subject.tool.card().unit,
    };
    let mut any = || {
        let near = 10f64.powf(draw.between(-8.0, 0.0));
        [0; 2].map(|_| near * draw.between(-1.0, 1.0))
    };
    given.points.extend((0..count).map(|_| at(any())));
    given.normals = vec![Vector3::z(); count + 1];
    given
}

/// Presses a tool into all three.
pub(super) fn tangent(subject: &Subject, count: usize, draw: &mut Draw, ledger: &mut Ledger) {
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
        // What is left of the depth when the tip is rounded.
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
    let error = Probe::new(&part, tool).error().expect("proved of every tool");
    let first = contacts.iter().find(|contact| contact.triangle == 0);
    let deep = closed.to_f64();
    match first {
        Some(first) => {
            let off = (&Big::exactly(first.depth) - closed).abs().to_f64();
            ledger.see(CLOSED, off / error, || shown(&pose));
        }
        None => ledger.count(MISSED, deep > error, || shown(&pose)),
    }
}

/// A ball whose pole is the origin and a corner of the mesh.
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
    Mesh::new(vertices, triangles, subject.tool.card().unit).expect("a ball")
}

/// The same contacts by the certifier, of triangles.
fn certified(subject: &Subject, side: Option<Side>, [size, round]: [f64; 2], ledger: &mut Ledger) {
    const SEGMENTS: u32 = 32;
    let unit = subject.tool.card().unit;
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
        // What is rounded here is less than a certifier's own error.
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
    let facets = Facets::new(mesh);
    let Ok(certifier) = Certifier::new(&facets, subject.tool) else { return };
    let exact = known(subject);
    let mut certifier = if exact { certifier } else { certifier.budget(BUDGET) };
    let pose = Pose::from_quaternion(tip, [0.0, 0.0, 0.0, 1.0]).expect("a unit quaternion");
    let [low, high] = certifier.deepest(&pose, 1e-9).depth;
    let reach = mesh.bounds().iter().map(|p| p.coords.amax()).fold(tip.coords.amax(), f64::max);
    // The circles of arcs count as the tool does.
    let circles = subject.tool.card().outline.iter().filter_map(|piece| piece.circle);
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
