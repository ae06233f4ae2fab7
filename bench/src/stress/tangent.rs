//! Item 8: grazing contacts, with depths of 1e-1 to 1e-15, on a plane, on a sphere and in a bore.
//!
//! The deepest point of the part is a point of the cloud at the world's origin. Its depth follows from the pose alone.

use super::ledger::{Kind, Ledger};
use super::scene::{PointSet, ProbeCheck, format_pose};
use super::truth::Subject;
use nalgebra::{Point3, Vector3};
use std::f64::consts::{PI, TAU};
use touchoff::certify::{Certifier, TriangleBvh};
use touchoff::mesh::shapes;
use touchoff::{Interval, Mesh, Pose, Probe, TriangleId};
use touchoff_tests::oracle::big::Big;
use touchoff_tests::oracle::restated;
use touchoff_tests::oracle::rng::Rng;

/// Error of the greatest depth relative to the closed form.
const CLOSED_FORM_ERROR: Kind = Kind::with_limit("closed form", "Probe::rounding_error_bound", 1.0);
/// A contact deeper than the error bound that was not found.
const MISSED_CONTACT: Kind = Kind::forbidden_event("contact missed");
/// Distance of the closed form from the certified interval.
const INTERVAL_MISS: Kind =
    Kind::with_limit("outside the certified interval", "64 ε (tool + part)", 1.0);
/// Width of the certified interval beyond 1e-9.
const EXCESS_WIDTH: Kind = Kind::with_limit("its width beyond 1e-9 mm", "256 ε (tool + part)", 1.0);
/// Width of the interval for a tool without a profile. The certifier knows its depth only by a bound on its change and
/// stops when the budget is spent, so the interval is valid but wide.
const FIELD_WIDTH: Kind = Kind::informational(
    "its width, of tools whose distance it does not know",
    "of the tool's unit",
);
/// Maximum number of nodes per query for such a tool.
const FIELD_BUDGET: u32 = 20_000;

/// A side of the tool: its radius, the height of its middle, and its length.
type Side = [f64; 3];

/// Returns the longest line of a tool's profile that is parallel to the axis, or a ball's equator. Returns `None` for a
/// solid.
fn longest_side(subject: &Subject) -> Option<Side> {
    match subject.name() {
        "UnitSphere" => return Some([1.0, 1.0, 1.0]),
        "Fig73" => return Some([1.0, 3.0, 4.0]),
        _ => {}
    }
    let tool = restated::of(subject.name())?;
    let mut from = tool.start;
    let mut longest: Option<Side> = None;
    for segment in tool.segments {
        let [d, low, high] = [&segment.to[0], &from[1], &segment.to[1]].map(Big::to_f64);
        if segment.centre.is_none() && from[0] == segment.to[0] && high > low {
            let side = [d, (low + high) / 2.0, high - low];
            longest = longest.filter(|longest| longest[2] >= side[2]).or(Some(side));
        }
        from = segment.to;
    }
    longest
}

/// Returns the depth to which a tool can be pressed into a plane such that its end is the surface nearest to the point
/// on its axis: half the radius of its end face or ball. Returns 0 for a tool whose end is neither.
fn max_press_depth(subject: &Subject) -> f64 {
    let Some(tool) = restated::of(subject.name()) else { return 0.5 };
    let (zero, first) = (Big::zero(), &tool.segments[0]);
    let has_flat_end = first.centre.is_none() && first.to[1] == zero && tool.start[1] == zero;
    let has_ball_end = first.centre.as_ref().is_some_and(|centre| centre[0] == zero);
    if has_flat_end || has_ball_end { 0.5 * first.to[0].to_f64() } else { 0.0 }
}

/// Returns whether a tool has a profile, so that the certifier knows its distance.
fn has_profile(subject: &Subject) -> bool {
    !subject.tool.info().outline.is_empty()
}

/// Returns points of a surface: the origin, then `count` points that `point_at` returns for numbers between -1 and 1.
fn surface_points(
    subject: &Subject,
    count: usize,
    rng: &mut Rng,
    point_at: impl Fn([f64; 2]) -> Point3<f64>,
) -> PointSet {
    let mut point_set = PointSet {
        points: vec![Point3::origin()],
        normals: Vec::new(),
        weights: vec![1.0; count + 1],
        unit: subject.tool.info().unit,
    };
    let mut random_parameters = || {
        let spread = 10f64.powf(rng.between(-8.0, 0.0));
        [0; 2].map(|_| spread * rng.between(-1.0, 1.0))
    };
    point_set.points.extend((0..count).map(|_| point_at(random_parameters())));
    point_set.normals = vec![Vector3::z(); count + 1];
    point_set
}

/// Presses a tool into a plane, a sphere and a bore.
pub(super) fn tangent_contacts(
    subject: &Subject,
    count: usize,
    rng: &mut Rng,
    ledger: &mut Ledger,
) {
    let size = subject.oracle.extent()[0].min(5.0);
    let depths = (1..=15).map(|k| 10f64.powi(-k) * size.min(1.0));
    let plane = surface_points(subject, count, rng, |[a, b]| Point3::new(a * size, b * size, 0.0));
    let side = longest_side(subject);
    let sphere_radius = side.map_or(size, |[.., length]| (length / 3.0).min(2.0 * size));
    let pole = Point3::origin();
    let sphere = surface_points(subject, count, rng, |[a, b]| {
        let (polar, azimuth) = (a * PI / 2.0, b * PI);
        let ring_radius = sphere_radius * polar.sin();
        let height_below_pole = sphere_radius * 2.0 * (polar / 2.0).sin().powi(2);
        pole + Vector3::new(
            height_below_pole,
            ring_radius * azimuth.cos(),
            ring_radius * azimuth.sin(),
        )
    });
    let bore = side.map(|[radius, ..]| {
        let bore_radius = radius + 0.1 * size;
        surface_points(subject, count, rng, |[a, b]| {
            let azimuth = a * PI;
            let setback = bore_radius * 2.0 * (azimuth / 2.0).sin().powi(2);
            Point3::new(-setback, bore_radius * azimuth.sin(), 0.02 * size * b)
        })
    });
    for depth in depths {
        let (tip, exact_depth) = (Point3::new(0.0, 0.0, -depth), Big::exactly(depth));
        let closed_form = (depth <= max_press_depth(subject)).then_some(&exact_depth);
        check_contact(subject, (&plane, tip), closed_form, ledger);
        let Some([radius, height, _]) = side else { continue };
        let offset = radius - depth;
        let tip = Point3::new(-offset, 0.0, -height);
        // The depth after the tip was rounded.
        let remaining_depth = &Big::decimal(radius) - &Big::exactly(offset);
        for point_set in [Some(&sphere), bore.as_ref()].into_iter().flatten() {
            check_contact(subject, (point_set, tip), Some(&remaining_depth), ledger);
        }
    }
    check_certifier(subject, side, [size, sphere_radius], ledger);
}

fn check_contact(
    subject: &Subject,
    (point_set, tip): (&PointSet, Point3<f64>),
    closed_form: Option<&Big>,
    ledger: &mut Ledger,
) {
    let pose = Pose::from_quaternion(tip, [0.0, 0.0, 0.0, 1.0]).expect("a unit quaternion");
    let part = point_set.part();
    let (tool, truth) = (subject.tool, &*subject.truth);
    let (contacts, _) = ProbeCheck { tool, truth, point_set, part: &part }.check(&pose, ledger);
    let Some(closed_form) = closed_form else { return };
    let error_bound = Probe::new(&part, tool).rounding_error_bound().expect("proved of every tool");
    let first = contacts.iter().find(|contact| contact.triangle == TriangleId(0));
    let depth = closed_form.to_f64();
    match first {
        Some(first) => {
            let error = (&Big::exactly(first.depth) - closed_form).abs().to_f64();
            ledger.record(CLOSED_FORM_ERROR, error / error_bound, || format_pose(&pose));
        }
        None => ledger.count(MISSED_CONTACT, depth > error_bound, || format_pose(&pose)),
    }
}

/// Returns a ball whose pole is at the origin and is a vertex of the mesh.
fn ball_mesh(radius: f64, subject: &Subject) -> Mesh {
    const RINGS: u32 = 6;
    const SIDES: u32 = 12;
    let mut vertices = vec![Point3::origin()];
    for ring in 1..RINGS {
        let polar = PI * f64::from(ring) / f64::from(RINGS);
        for side in 0..SIDES {
            let azimuth = TAU * f64::from(side) / f64::from(SIDES);
            let offset = radius * (1.0 - polar.cos());
            let ring_radius = radius * polar.sin();
            vertices.push(Point3::new(
                offset,
                ring_radius * azimuth.cos(),
                ring_radius * azimuth.sin(),
            ));
        }
    }
    vertices.push(Point3::new(2.0 * radius, 0.0, 0.0));
    let index_of = |ring: u32, side: u32| 1 + (ring - 1) * SIDES + side % SIDES;
    let last_index = vertices.len() as u32 - 1;
    let mut triangles = Vec::new();
    for side in 0..SIDES {
        triangles.push([0, index_of(1, side), index_of(1, side + 1)]);
        triangles.push([last_index, index_of(RINGS - 1, side + 1), index_of(RINGS - 1, side)]);
        for ring in 1..RINGS - 1 {
            let [a, b] = [index_of(ring, side), index_of(ring, side + 1)];
            let [c, d] = [index_of(ring + 1, side + 1), index_of(ring + 1, side)];
            triangles.extend([[a, c, b], [a, d, c]]);
        }
    }
    Mesh::new(vertices, triangles, subject.tool.info().unit).expect("a ball")
}

/// Queries the certifier for the same contacts, with triangles.
fn check_certifier(
    subject: &Subject,
    side: Option<Side>,
    [size, sphere]: [f64; 2],
    ledger: &mut Ledger,
) {
    const SEGMENTS: u32 = 32;
    let unit = subject.tool.info().unit;
    let plane = shapes::plane(2.0 * size, 4, unit).expect("a plane");
    let sphere = ball_mesh(sphere, subject);
    let ring = side.map(|[radius, ..]| {
        let ring_radius = radius + 0.1 * size;
        let ring_height = 0.04 * size;
        shapes::tube(ring_radius, ring_radius + size, ring_height, SEGMENTS, 1, unit)
            .expect("a ring")
    });
    for depth in (1..=15).map(|k| 10f64.powi(-k) * size.min(1.0)) {
        if depth <= max_press_depth(subject) {
            check_interval(subject, &plane, Point3::new(0.0, 0.0, -depth), depth, ledger);
        }
        let (Some([radius, height, _]), Some(ring)) = (side, &ring) else { continue };
        // The rounding here is smaller than the certifier's own error.
        let offset = radius - depth;
        check_interval(
            subject,
            &sphere,
            Point3::new(-offset, 0.0, -height),
            radius - offset,
            ledger,
        );
        let half_angle = PI / f64::from(SEGMENTS);
        let facet_distance = (radius + 0.1 * size) * half_angle.cos();
        let outward = facet_distance - offset;
        let tip = Point3::new(
            outward * half_angle.cos(),
            outward * half_angle.sin(),
            0.02 * size - height,
        );
        check_interval(subject, ring, tip, radius - offset, ledger);
    }
}

fn check_interval(
    subject: &Subject,
    mesh: &Mesh,
    tip: Point3<f64>,
    depth: f64,
    ledger: &mut Ledger,
) {
    let bvh = TriangleBvh::new(mesh);
    let Ok(certifier) = Certifier::new(&bvh, subject.tool) else { return };
    let has_profile = has_profile(subject);
    let mut certifier = if has_profile { certifier } else { certifier.with_budget(FIELD_BUDGET) };
    let pose = Pose::from_quaternion(tip, [0.0, 0.0, 0.0, 1.0]).expect("a unit quaternion");
    let Interval { low, high } = certifier.deepest(&pose, 1e-9).depth;
    let max_coordinate =
        mesh.bounds().iter().map(|p| p.coords.amax()).fold(tip.coords.amax(), f64::max);
    // The error bound depends on the circles of arcs as on the tool itself.
    let circles = subject.tool.info().outline.iter().filter_map(|segment| segment.circle);
    let circles = circles.map(|circle| circle.centre[0].hypot(circle.centre[1]) + circle.radius);
    let rounding = f64::EPSILON * (circles.fold(subject.scale(), f64::max) + max_coordinate);
    let miss = (low - depth).max(depth - high).max(0.0);
    let location = || format!("depth {depth:e} in {low:e} to {high:e}, {}", format_pose(&pose));
    ledger.record(INTERVAL_MISS, miss / (64.0 * rounding), location);
    if has_profile {
        ledger.record(EXCESS_WIDTH, (high - low - 1e-9).max(0.0) / (256.0 * rounding), location);
    } else {
        ledger.record_info(FIELD_WIDTH, 1, high - low, &location());
    }
}
