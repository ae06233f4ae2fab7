//! Item 8: grazing contacts. A tool's end is pressed into a plane, its longest side into a sphere and into a bore that is
//! wider by a tenth, by 1e-1 … 1e-15. The deepest place of the part is a point of the cloud at the world's origin, so the
//! depth follows from the pose alone. The certifier's interval, from triangles, contains it.

use crate::prelude::*;
use std::f64::consts::PI;
use touchoff::certify::{Certifier, TriangleBvh};
use touchoff::mesh::shapes;
use touchoff::{Interval, Mesh, TriangleId};
use touchoff_tests::oracle::restated;

/// Maximum number of nodes per query for a tool without a profile. The certifier knows its depth only by a bound on its
/// change and stops when the budget is spent, so the interval is valid but wide.
const FIELD_BUDGET: u32 = 20_000;

/// Number of segments of the ring around a bore of triangles.
const SEGMENTS: u32 = 32;

#[test]
fn tangent_contacts_have_their_closed_form() {
    check_tools(8, |subject, rng, checks| {
        let surfaces = Surfaces::new(subject);
        check_points(&surfaces, rng, checks);
        check_triangles(&surfaces, checks);
    });
}

/// The longest line of a profile that is parallel to the axis, or a ball's equator.
#[derive(Clone, Copy)]
struct Side {
    radius: f64,
    /// The height of its middle.
    middle: f64,
    length: f64,
}

/// The surfaces that a tool is pressed into: the plane z = 0, a sphere that touches x = 0 from x > 0, and a bore whose
/// wall touches x = 0 from x > 0.
struct Surfaces<'a> {
    subject: &'a Subject,
    /// The extent of the points: the tool's radius, at most 5.
    size: f64,
    side: Option<Side>,
    sphere_radius: f64,
    bore_radius: f64,
}

impl Surfaces<'_> {
    fn new(subject: &Subject) -> Surfaces<'_> {
        let size = subject.oracle.extent()[0].min(5.0);
        let side = longest_side(subject);
        Surfaces {
            subject,
            size,
            side,
            sphere_radius: side.map_or(size, |side| (side.length / 3.0).min(2.0 * size)),
            bore_radius: side.map_or(size, |side| side.radius) + 0.1 * size,
        }
    }

    fn depths(&self) -> impl Iterator<Item = f64> {
        let largest = self.size.min(1.0);
        (1..=15).map(move |k| 10f64.powi(-k) * largest)
    }
}

/// Returns the longest side; `None` for a solid without an axis.
fn longest_side(subject: &Subject) -> Option<Side> {
    match subject.name() {
        "UnitSphere" => return Some(Side { radius: 1.0, middle: 1.0, length: 1.0 }),
        "Fig73" => return Some(Side { radius: 1.0, middle: 3.0, length: 4.0 }),
        _ => {}
    }
    let mut longest: Option<Side> = None;
    for segment in restated::of(subject.name())?.profile.segments() {
        let [radius, low, high] =
            [&segment.to[0], &segment.from[1], &segment.to[1]].map(Big::to_f64);
        if segment.circle.is_none() && segment.from[0] == segment.to[0] && high > low {
            let side = Side { radius, middle: (low + high) / 2.0, length: high - low };
            longest = longest.filter(|longest| longest.length >= side.length).or(Some(side));
        }
    }
    longest
}

/// Returns the depth to which a tool can be pressed into a plane such that its end is the surface nearest to the point
/// on its axis: half the radius of its end face or ball. Returns 0 for a tool whose end is neither.
fn max_press_depth(subject: &Subject) -> f64 {
    let Some(tool) = restated::of(subject.name()) else { return 0.5 };
    let first = tool.profile.map(Big::to_f64).segments()[0];
    let has_flat_end = first.circle.is_none() && first.to[1] == 0.0 && first.from[1] == 0.0;
    let has_ball_end = first.centre().is_some_and(|centre| centre[0] == 0.0);
    let widest = first.extremes().map(|p| p[0]).fold(0.0, f64::max);
    if has_flat_end || has_ball_end { 0.5 * widest } else { 0.0 }
}

/// Returns points of a surface: the origin, and others that `point_at` returns for numbers between -1 and 1.
fn points(
    subject: &Subject,
    rng: &mut Rng,
    point_at: impl Fn([f64; 2]) -> Point3<f64>,
) -> PointSet {
    let mut points = vec![Point3::origin()];
    points.extend((0..extent(1, 25)).map(|_| {
        // As many within 1e-8 as within 1e-1.
        let spread = rng.power(-8.0, 0.0);
        point_at([0; 2].map(|_| spread * rng.between(-1.0, 1.0)))
    }));
    PointSet {
        normals: vec![Vector3::z(); points.len()],
        weights: vec![1.0; points.len()],
        points,
        unit: subject.tool.info().unit,
    }
}

fn check_points(surfaces: &Surfaces<'_>, rng: &mut Rng, checks: &mut Checks) {
    let Surfaces { subject, size, side, sphere_radius, bore_radius } = *surfaces;
    let plane = points(subject, rng, |[a, b]| Point3::new(a * size, b * size, 0.0));
    let sphere = points(subject, rng, |[a, b]| {
        let (polar, azimuth) = (a * PI / 2.0, b * PI);
        let ring_radius = sphere_radius * polar.sin();
        let x = sphere_radius * 2.0 * (polar / 2.0).sin().powi(2);
        Point3::new(x, ring_radius * azimuth.cos(), ring_radius * azimuth.sin())
    });
    let mut bore = || {
        points(subject, rng, |[a, b]| {
            let azimuth = a * PI;
            let x = -bore_radius * 2.0 * (azimuth / 2.0).sin().powi(2);
            Point3::new(x, bore_radius * azimuth.sin(), 0.02 * size * b)
        })
    };
    let beside_side = side.map(|side| (side, [sphere, bore()]));
    for depth in surfaces.depths() {
        let tip = Point3::new(0.0, 0.0, -depth);
        let exact = (depth <= max_press_depth(subject)).then(|| Big::exactly(depth));
        check_contact(subject, &plane, tip, exact.as_ref(), checks);
        let Some((side, surfaces)) = &beside_side else { continue };
        let offset = side.radius - depth;
        // The depth after the tip was rounded.
        let exact = &Big::decimal(side.radius) - &Big::exactly(offset);
        for points in surfaces {
            let tip = Point3::new(-offset, 0.0, -side.middle);
            check_contact(subject, points, tip, Some(&exact), checks);
        }
    }
}

/// Checks all contacts, and the depth of the point at the origin where it is known.
fn check_contact(
    subject: &Subject,
    points: &PointSet,
    tip: Point3<f64>,
    exact: Option<&Big>,
    checks: &mut Checks,
) {
    let scene = Scene::new(subject, points.clone(), pose(tip, [0.0, 0.0, 0.0, 1.0]));
    let contacts = scene.check(checks).contacts;
    let Some(exact) = exact else { return };
    let bound = scene.error_bound();
    let place = || format_pose(&scene.pose);
    match contacts.iter().find(|contact| contact.triangle == TriangleId(0)) {
        Some(contact) => {
            let error = (&Big::exactly(contact.depth) - exact).abs().to_f64();
            checks.within("closed form [Probe::rounding_error_bound]", error / bound, 1.0, place);
        }
        None => checks.never("contact missed", exact.to_f64() > bound, place),
    }
}

/// Queries the certifier for the same contacts.
fn check_triangles(surfaces: &Surfaces<'_>, checks: &mut Checks) {
    let Surfaces { subject, size, side, sphere_radius, bore_radius } = *surfaces;
    let unit = subject.tool.info().unit;
    let plane = shapes::plane(2.0 * size, 4, unit).expect("a plane");
    // Once divided, the icosahedron has a vertex at (-1, 0, 0).
    let sphere = shapes::sphere(sphere_radius, 1, unit).expect("a sphere");
    let to_origin = Vector3::new(sphere_radius, 0.0, 0.0);
    let vertices: Vec<Point3<f64>> = sphere.vertices().iter().map(|p| p + to_origin).collect();
    assert!(vertices.contains(&Point3::origin()));
    let sphere = Mesh::new(vertices, sphere.triangles().to_vec(), unit).expect("a sphere");
    let ring = shapes::tube(bore_radius, bore_radius + size, 0.04 * size, SEGMENTS, 1, unit);
    let ring = ring.expect("a ring");
    for depth in surfaces.depths() {
        if depth <= max_press_depth(subject) {
            check_interval(subject, &plane, Point3::new(0.0, 0.0, -depth), depth, checks);
        }
        let Some(Side { radius, middle, .. }) = side else { continue };
        // The rounding here is smaller than the certifier's own error.
        let offset = radius - depth;
        let tip = Point3::new(-offset, 0.0, -middle);
        check_interval(subject, &sphere, tip, radius - offset, checks);
        // Into the middle of a facet.
        let (sin, cos) = (PI / f64::from(SEGMENTS)).sin_cos();
        let outward = bore_radius * cos - offset;
        let tip = Point3::new(outward * cos, outward * sin, 0.02 * size - middle);
        check_interval(subject, &ring, tip, radius - offset, checks);
    }
}

fn check_interval(
    subject: &Subject,
    mesh: &Mesh,
    tip: Point3<f64>,
    depth: f64,
    checks: &mut Checks,
) {
    let bvh = TriangleBvh::new(mesh);
    let Ok(mut certifier) = Certifier::new(&bvh, subject.tool) else { return };
    let outline = &subject.tool.info().outline;
    if outline.is_empty() {
        certifier = certifier.with_budget(FIELD_BUDGET);
    }
    let pose = pose(tip, [0.0, 0.0, 0.0, 1.0]);
    let Interval { low, high } = certifier.deepest(&pose, 1e-9).depth;
    // The error bound depends on the circles of arcs as on the tool itself.
    let circles = outline.iter().filter_map(|segment| segment.circle);
    let circles = circles.map(|circle| circle.centre[0].hypot(circle.centre[1]) + circle.radius);
    let tool_size = circles.fold(subject.scale(), f64::max);
    let part_size = mesh.bounds().iter().map(|p| p.coords.amax()).fold(tip.coords.amax(), f64::max);
    let rounding = f64::EPSILON * (tool_size + part_size);
    let place = || format!("depth {depth:e} in {low:e} to {high:e}, {}", format_pose(&pose));
    let outside = (low - depth).max(depth - high).max(0.0) / rounding;
    checks.within("outside the certified interval [ε (tool + part)]", outside, 64.0, place);
    if !outline.is_empty() {
        let excess = (high - low - 1e-9).max(0.0) / rounding;
        checks.within("width of the interval beyond 1e-9 [ε (tool + part)]", excess, 256.0, place);
    }
}
