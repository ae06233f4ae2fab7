//! Bounds of triangles and nodes, against sampled points.

use super::*;
use crate::bvh::QuerySetup;
use crate::certify::bounds::descent::{BoundedTree, Node, of_children};
use crate::certify::part::TriangleBvh;
use crate::certify::space::Point;
use crate::mesh::Mesh;
use crate::pose::Pose;
use crate::tool::Interpreted;
use crate::tool::Tool;
use crate::unit::Unit;
use fearless_simd::{Level, dispatch, f64x8};
use nalgebra::{Point3, Vector3};
use std::f64::consts::FRAC_PI_2;
use std::sync::LazyLock;

const ERROR: f64 = 1e-12;

static NECKED: LazyLock<Interpreted> = LazyLock::new(|| {
    r#"tool Necked "reflex corners between lines, and a convex corner above one" {
        units mm;
        profile {
            start (0, 0);
            arc to (1, 1) center (0, 1) as nose cutting;
            line to (1, 5) as flute cutting;
            line to (3, 7), (3, 9) as neck;
            line to (5, 9), (5, 20), (0, 20) as housing;
        }
        niceness cutting: 1;
    }"#
    .parse()
    .expect("a tool")
});

static WAISTED: LazyLock<Interpreted> = LazyLock::new(|| {
    r#"tool Waisted "a waist between cones" {
        units mm;
        profile {
            start (0, 0);
            line to (4, 0) as face cutting;
            line to (5, 6) as side cutting;
            line to (2, 9), (2, 15) as neck;
            line to (6, 18), (0, 20) as head;
        }
        niceness cutting: 1;
    }"#
    .parse()
    .expect("a tool")
});

static ROUNDED: LazyLock<Interpreted> = LazyLock::new(|| {
    r#"tool Rounded "convex and concave arcs beside lines" {
        units mm;
        profile {
            start (0, 0);
            line to (2, 0) as face cutting;
            arc to (4, 2) center (2, 2) as edge cutting;
            line to (3, 8) as side cutting;
            arc to (5, 10) center (5, 8) concave as fillet;
            line to (7, 14), (7, 16), (0, 16) as shank;
        }
        niceness cutting: 1;
    }"#
    .parse()
    .expect("a tool")
});

static HOLLOW: LazyLock<Interpreted> = LazyLock::new(|| {
    r#"tool Hollow "a cone from below, so that the profile runs downward first" {
        units mm;
        profile {
            start (0, 4);
            line to (4, 0) as cup cutting;
            line to (6, 0), (6, 12), (0, 12) as body;
        }
        niceness cutting: 1;
    }"#
    .parse()
    .expect("a tool")
});

/// A ball and a rounded shoulder of 3 mm radius, as polylines of 48 chords.
static CHORDED: LazyLock<Interpreted> = LazyLock::new(|| {
    let chords = |[d, z]: [f64; 2]| {
        let points = (1..48).map(|k| {
            let (sine, cosine) = (f64::from(k) / 48.0 * FRAC_PI_2).sin_cos();
            format!("({:.5}, {:.5})", d + 3.0 * sine, z - 3.0 * cosine)
        });
        points.collect::<Vec<String>>().join(", ")
    };
    let [ball, shoulder] = [[0.0, 3.0], [3.5, 9.0]].map(chords);
    let text = format!(
        r#"tool Chorded "chords" {{
            units mm;
            profile {{
                start (0, 0);
                line to {ball}, (3, 3) as ball cutting;
                line to (3, 6) as flute cutting;
                line to (3.5, 6), {shoulder}, (6.5, 9), (6.5, 16), (0, 16) as shank;
            }}
            niceness cutting: 1;
        }}"#
    );
    text.parse().expect("a tool")
});

/// Returns the tools of these tests.
fn tools() -> [&'static ToolInfo; 5] {
    [NECKED.info(), WAISTED.info(), ROUNDED.info(), HOLLOW.info(), CHORDED.info()]
}

/// Returns the model of a tool, and zones that hold all of it.
fn whole(info: &ToolInfo) -> (ProfileModel, Vec<Option<Rectangle>>) {
    let profile = ProfileModel::new(info, ERROR).expect("a profile");
    let zones = profile.section.slabs.iter().map(|slab| Some(slab.rectangle())).collect();
    (profile, zones)
}

#[test]
fn chords_of_a_ball_are_bounded_by_it_and_those_of_a_shoulder_together() {
    let ProfileModel { section, chains, .. } =
        ProfileModel::new(CHORDED.info(), ERROR).expect("a profile");
    let in_ball =
        chains.iter().filter_map(|chain| Some((chain.slabs.end, chain.ball?))).next_back();
    let (slabs, [centre, radius]) = in_ball.expect("a ball");
    assert!(slabs == 48 && (centre - 3.0).abs() < 1e-5 && (radius - 3.0).abs() < 1e-5);
    let chains = chains.iter().map(|chain| chain.slabs.clone());
    assert!(chains.clone().flatten().eq(0..section.slabs.len()));
    // Below the flattest of them the tool continues.
    let shoulder = chains.filter(|slabs| slabs.start > 48 && slabs.len() > 1);
    assert!(shoulder.flatten().count() > 0);
}

/// A sequence of numbers from 0 to 1 that looks random.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }

    /// Returns a triangle of some size near the tool.
    fn triangle(&mut self, section: &Section) -> [Point; 3] {
        let [low, high] = section.reach();
        let size = 8.0 * self.next().powi(3);
        let middle =
            [self.between(-5.0, 5.0), self.between(-5.0, 5.0), self.between(low - 1.0, high + 1.0)];
        [(); 3].map(|()| middle.map(|at| at + size * self.between(-1.0, 1.0)))
    }
}

/// Returns the greatest depth of some points of a triangle, by the distances from all segments.
fn sampled(section: &Section, [a, b, c]: &[Point; 3]) -> f64 {
    const STEPS: u32 = 24;
    let mut deepest = f64::NEG_INFINITY;
    for i in 0..=STEPS {
        for j in 0..=STEPS - i {
            let (u, v) = (f64::from(i) / f64::from(STEPS), f64::from(j) / f64::from(STEPS));
            let [x, y, z] = [0, 1, 2].map(|k| a[k] + u * (b[k] - a[k]) + v * (c[k] - a[k]));
            let p = [x.hypot(y), z];
            if section.contains(p) {
                deepest = deepest.max(section.unsigned_distance(p));
            }
        }
    }
    deepest
}

#[test]
fn no_sampled_point_of_a_triangle_is_deeper_than_its_bounds() {
    let mut numbers = Numbers(1);
    let (mut inside, mut refined) = (0, 0);
    for info in tools() {
        let (profile, zones) = whole(info);
        let hull = Hull::<f64>::new(&profile, &zones, ERROR);
        for _ in 0..3000 {
            let triangle = numbers.triangle(&profile.section);
            let deepest = sampled(&profile.section, &triangle);
            let [first, second] =
                dispatch!(Level::new(), simd => both_bounds(simd, &hull, &triangle));
            assert!(deepest <= first + 1e-9, "{}: {triangle:?} {deepest} {first}", info.name);
            assert!(deepest <= second + 1e-9, "{}: {triangle:?} {deepest} {second}", info.name);
            inside += usize::from(deepest > 0.0);
            refined += usize::from(second < first);
        }
    }
    assert!(inside > 3000 && refined > 1000, "{inside} {refined}");
}

/// Returns the bound of a triangle, and that at its likely deepest point.
fn both_bounds<S: Simd>(simd: S, hull: &Hull<f64>, triangle: &[Point; 3]) -> [f64; 2] {
    let corners = triangle.map(|p| p.map(|at| f64x8::splat(simd, at)));
    let (first, point) = hull.triangles(simd, &corners, 0.0, None);
    let (second, _) = hull.triangles(simd, &corners, 0.0, Some(&point));
    [first[0], second[0]]
}

#[test]
fn a_triangle_that_touches_an_arc_is_not_deep() {
    let (profile, zones) = whole(ROUNDED.info());
    let hull = Hull::<f64>::new(&profile, &zones, ERROR);
    for (degrees, turn) in [(1, 0.0), (20, 1.0), (45, 2.0), (70, 3.0), (60, -2.0)] {
        // Outward from the centre of the edge: down at 0 degrees. Beyond 70 the shank, which is wider, reaches farther.
        let (sine, cosine) = f64::from(degrees).to_radians().sin_cos();
        let azimuth = Vector3::new(f64::cos(turn), f64::sin(turn), 0.0);
        let out = azimuth * sine - Vector3::z() * cosine;
        let touch = azimuth * 2.0 + Vector3::z() * 2.0 + out * 2.0;
        let [u, v] = [azimuth.cross(&Vector3::z()), azimuth * cosine + Vector3::z() * sine];
        for deep in [0.0, 0.125] {
            let corners = [[-2.0, -1.0], [2.0, -2.0], [0.5, 3.0]]
                .map(|[x, y]| (touch - out * deep + u * x + v * y).into());
            let [bound, _] = dispatch!(Level::new(), simd => both_bounds(simd, &hull, &corners));
            assert!((bound - deep).abs() < 1e-12, "{degrees}: {bound}, not {deep}");
        }
    }
}

#[test]
fn no_sampled_point_of_a_node_is_deeper_than_its_bound() {
    let mut numbers = Numbers(2);
    let mut inside = 0;
    for info in tools() {
        let (profile, zones) = whole(info);
        for _ in 0..60 {
            // A strip of triangles that is almost plane, in places flat.
            let [at, across, up] = [(); 3].map(|()| {
                Vector3::new(
                    numbers.between(-3.0, 3.0),
                    numbers.between(-3.0, 3.0),
                    numbers.between(-3.0, 3.0),
                )
            });
            let at = Point3::new(0.0, 0.0, numbers.between(0.0, 16.0)) + at;
            let bend = numbers.between(-0.02, 0.02);
            let vertices = (0..20 * 20).map(|k| {
                let [u, v] = [k / 20, k % 20].map(|k| f64::from(k) / 10.0 - 1.0);
                at + across * u + up * v + across.cross(&up) * (bend * u * u)
            });
            let triangles = (0..19 * 19).flat_map(|k: u32| {
                let corner = k / 19 * 20 + k % 19;
                [[corner, corner + 1, corner + 20], [corner + 1, corner + 21, corner + 20]]
            });
            let mesh = Mesh::new(vertices, triangles, Unit::Millimetre).expect("a mesh");
            let bvh = TriangleBvh::new(&mesh);
            let setup = QuerySetup::new(&bvh.frame, info, 1.0);
            let margin = setup.margin;
            let hull = Hull::<f32>::new(&profile, &zones, margin);
            let mut view = PoseTransform::default();
            let pose = Pose::from_axis(Point3::origin(), Vector3::z()).expect("a unit vector");
            if !setup.set_pose(&bvh.frame, &pose, &mut view) {
                continue;
            }
            let tree = BoundedTree { bvh: &bvh, bounds: &hull, view: &view };
            let root = Node { level: 0, index: 0, bound: f32::INFINITY };
            let mut bounds = [0.0f32; 16];
            of_children(Level::new(), &tree, root, f32::NEG_INFINITY, &mut bounds);
            let below = 16usize.pow(bvh.levels.len() as u32);
            for (child, triangles) in bvh.corners.chunks(below).enumerate() {
                let axes = pose.rotation().transpose();
                let deepest = triangles.iter().map(|corners| {
                    let corners = corners.map(|p| (axes * Vector3::from(p)).into());
                    sampled(&profile.section, &corners)
                });
                let deepest = deepest.fold(f64::NEG_INFINITY, f64::max);
                let bound = f64::from(bounds[child]) + 4.0 * margin;
                assert!(deepest <= bound, "{}: {deepest} {bound}", info.name);
                inside += usize::from(deepest > 0.0);
            }
        }
    }
    assert!(inside > 200, "{inside}");
}

/// A triangle that is beside the housing where it is as high, and below it where it is nearer to the axis.
#[test]
fn a_triangle_that_passes_below_a_step_is_not_deep() {
    let (profile, zones) = whole(NECKED.info());
    let hull = Hull::<f64>::new(&profile, &zones, ERROR);
    let corners = [[3.5, 0.0, 8.9], [8.5, 0.0, 9.2], [8.5, 1.0, 9.2]];
    let [bound, _] = dispatch!(Level::new(), simd => both_bounds(simd, &hull, &corners));
    assert!(bound < 0.0, "{bound}");
}
