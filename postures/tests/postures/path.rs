//! Paths: no cutter location and no motion is deeper than the tolerance at any sample point.

use crate::{HOLDER, MILL, NECK, cutting_distance, is_inside, polyline_distance};
use nalgebra::{Point3, Rotation3, Vector3};
use std::f64::consts::PI;
use std::num::NonZeroU16;
use std::ops::ControlFlow;
use std::sync::LazyLock;
use touchoff::certify::TriangleBvh;
use touchoff::mesh::shapes;
use touchoff::tool::Interpreted;
use touchoff::{Mesh, Tool, TriangleId, Unit};
use touchoff_postures::path::{
    LeftOutReason, PathError, PathRequest, Pattern, ToolAxisLimits, ToolPath,
};
use touchoff_postures::sweep::PostureSweep;
use touchoff_postures::{Directions, Rules};

static WIDE: LazyLock<Interpreted> = LazyLock::new(|| {
    r#"tool Wide "a bull nose that is larger than most parts here" {
        units mm;
        profile {
            start (0, 0);
            line to (60, 0) as face cutting;
            arc to (65, 5) center (60, 5) as corner cutting;
            line to (65, 40), (0, 40) as body;
        }
        niceness cutting: 1;
    }"#
    .parse()
    .expect("a tool")
});

const TOLERANCE: f64 = 0.01;

/// A part with all inputs of a path. Lengths in mm are converted to the part's unit.
struct Case {
    mesh: Mesh,
    bvh: TriangleBvh,
    rules: Rules,
    directions: Directions,
    access: Vec<Vec<u64>>,
    scale: f64,
}

impl Case {
    fn new(mesh: Mesh, tool: &dyn Tool) -> Case {
        let scale = Unit::Millimetre.factor_to(mesh.unit());
        let rules = Rules { tolerance: TOLERANCE * scale, niceness: 0.5, allowed: Vec::new() };
        let (bvh, directions) = (TriangleBvh::new(&mesh), Directions::spread(100));
        let mut access = vec![Vec::new(); mesh.triangles().len()];
        let sweep =
            PostureSweep::new(&mesh, &bvh, vec![tool], &directions, rules.clone(), NonZeroU16::MIN)
                .expect("a sweep");
        let all: Vec<usize> = (0..sweep.batches()).collect();
        let _: ControlFlow<()> = sweep.run(&all, |batch| {
            for (id, mut row) in batch.rows {
                access[id.index()] = std::mem::take(&mut row.access[0].directions);
            }
            ControlFlow::Continue(())
        });
        Case { mesh, bvh, rules, directions, access, scale }
    }

    fn request<'a>(&'a self, tool: &'a dyn Tool, pattern: &'a Pattern) -> PathRequest<'a> {
        PathRequest {
            mesh: &self.mesh,
            bvh: &self.bvh,
            stock: None,
            tool,
            rules: &self.rules,
            directions: &self.directions,
            accessibility: &self.access,
            pattern,
            max_tilt: PI,
            axis_limits: None,
        }
    }

    fn plan(&self, tool: &dyn Tool, pattern: &Pattern) -> Result<ToolPath, PathError> {
        self.request(tool, pattern).plan()
    }

    /// Plans a path over planes with a normal. Distances are in mm.
    fn plan_over_planes(
        &self,
        tool: &dyn Tool,
        normal: [f64; 3],
        [stepover, step]: [f64; 2],
    ) -> ToolPath {
        let [stepover, step] = [stepover, step].map(|length| length * self.scale);
        self.plan(tool, &Pattern { normal, stepover, step }).expect("a path")
    }
}

/// Returns sample points of a mesh, at most `spacing` from each other along the sides of each triangle.
fn sample_mesh(mesh: &Mesh, spacing: f64) -> Vec<Point3<f64>> {
    let mut points = Vec::new();
    for id in 0..mesh.triangles().len() as u32 {
        let [a, b, c] = mesh.triangle(TriangleId(id));
        let longest = (b - a).norm().max((c - a).norm()).max((c - b).norm());
        let count = (longest / spacing).ceil();
        for i in 0..=count as u32 {
            for j in 0..=count as u32 - i {
                points
                    .push(a + (b - a) * (f64::from(i) / count) + (c - a) * (f64::from(j) / count));
            }
        }
    }
    points
}

/// Returns the largest depth of a [`Mill`]'s cutting surfaces and of its other surfaces in a mesh over a path, in mm: on
/// feed moves, and on rapid moves.
fn max_depths(mesh: &Mesh, path: &ToolPath) -> [[f64; 2]; 2] {
    /// Least number of steps in a motion.
    const TIME_STEPS: f64 = 6.0;
    let scale = Unit::Millimetre.factor_to(mesh.unit());
    let points = sample_mesh(mesh, 0.5 * scale);
    let mut depths = [[0f64; 2]; 2];
    for pair in path.locations.windows(2) {
        let (from, to, rapid) = (pair[0].0, pair[1].0, usize::from(pair[1].1));
        let axis_of_rotation = from.axis().cross(&to.axis());
        let angle = from.axis().angle(&to.axis());
        // The tip moves at most 0.5 mm per step, so that long links are sampled as densely as short motions.
        let steps = (2.0 * (to.tip() - from.tip()).norm() / scale).ceil().max(TIME_STEPS);
        for k in 0..=steps as u32 {
            let fraction = f64::from(k) / steps;
            let tip = from.tip() + (to.tip() - from.tip()) * fraction;
            let axis = match axis_of_rotation.try_normalize(1e-12) {
                Some(axis_of_rotation) => {
                    let axis_of_rotation = nalgebra::Unit::new_unchecked(axis_of_rotation);
                    Rotation3::from_axis_angle(&axis_of_rotation, angle * fraction) * from.axis()
                }
                None => from.axis(),
            };
            for point in &points {
                let offset = (point - tip) / scale;
                let z = offset.dot(&axis);
                if !(0.0..=40.0).contains(&z) {
                    continue;
                }
                let point = [(offset.norm_squared() - z * z).max(0.0).sqrt(), z];
                if is_inside(point) {
                    let (cutting, non_cutting) = (
                        cutting_distance(point),
                        polyline_distance(&NECK, point).min(polyline_distance(&HOLDER, point)),
                    );
                    let surface_kind = usize::from(non_cutting < cutting);
                    depths[rapid][surface_kind] =
                        depths[rapid][surface_kind].max(cutting.min(non_cutting));
                }
            }
        }
    }
    depths
}

/// Returns the length of the tip's path in feed and in rapid traverse.
fn lengths(path: &ToolPath) -> [f64; 2] {
    let mut lengths = [0.0; 2];
    for pair in path.locations.windows(2) {
        lengths[usize::from(pair[1].1)] += (pair[1].0.tip() - pair[0].0.tip()).norm();
    }
    lengths
}

/// Returns a block with a step along y. Its corners are given as `[x, z]`.
fn step() -> Mesh {
    let outline = [[-12.0, 0.0], [12.0, 0.0], [12.0, 8.0], [0.0, 8.0], [0.0, 14.0], [-12.0, 14.0]];
    let point_at = |y: f64| move |[x, z]: [f64; 2]| Point3::new(x, y, z);
    let vertices = outline.map(point_at(-10.0)).into_iter().chain(outline.map(point_at(10.0)));
    let mut triangles = Vec::new();
    for k in 0..6u32 {
        let next = (k + 1) % 6;
        triangles.extend([[k, next, next + 6], [k, next + 6, k + 6]]);
    }
    // All corners are visible from the inner one, so a fan of triangles covers each end face.
    for (a, b) in [(4, 5), (5, 0), (0, 1), (1, 2)] {
        triangles.extend([[3, b, a], [9, a + 6, b + 6]]);
    }
    let mesh = Mesh::new(vertices, triangles, Unit::Millimetre).expect("a mesh");
    let turned = mesh.triangles().iter().map(|[a, b, c]| [*a, *c, *b]);
    match mesh.diagnostics().is_solid() {
        true => mesh,
        false => Mesh::new(mesh.vertices().to_vec(), turned, Unit::Millimetre).expect("a mesh"),
    }
}

fn sphere() -> Mesh {
    shapes::sphere(10.0, 3, Unit::Millimetre).expect("a sphere")
}

static SPHERE: LazyLock<Case> = LazyLock::new(|| Case::new(sphere(), &*MILL));
static STEP: LazyLock<Case> = LazyLock::new(|| Case::new(step(), &*MILL));

fn plan_and_check(case: &Case, normal: [f64; 3], spacing: [f64; 2]) -> ToolPath {
    let path = case.plan_over_planes(&*MILL, normal, spacing);
    let [feed, rapid] = max_depths(&case.mesh, &path);
    println!(
        "{} locations, {} contact points, {} left out, {} retracts, turns {:?}, feed {feed:?}, rapid {rapid:?}",
        path.locations.len(),
        path.contact_points,
        path.left_out.len(),
        path.retracts,
        path.turns
    );
    assert!(feed[0] <= TOLERANCE + 1e-9 && feed[1] <= TOLERANCE / 8.0 + 1e-9, "{feed:?}");
    assert!(rapid[0] <= TOLERANCE + 1e-9 && rapid[1] <= TOLERANCE / 8.0 + 1e-9, "{rapid:?}");
    let distinct = path.locations.windows(2).all(|pair| {
        pair[0].0.tip() != pair[1].0.tip() || pair[0].0.axis().angle(&pair[1].0.axis()) > 1e-6
    });
    assert!(distinct, "every motion moves the tool");
    let [feed, rapid] = lengths(&path);
    println!("{feed:.1} in feed, {rapid:.1} in rapid traverse");
    assert!(rapid <= 1.5 * feed, "links stay near the part: {rapid} of {feed}");
    assert!(path.contact_points > 100 && path.turns[1] <= path.turns[0], "{path:?}");
    let [low, high] = case.mesh.bounds();
    for (end, rapid) in [path.locations[0], path.locations[path.locations.len() - 1]] {
        assert!(rapid);
        assert!((end.tip() - nalgebra::center(&low, &high)).norm() > 0.9 * (high - low).norm());
        assert!((end.axis() - Vector3::z()).norm() < 1e-12, "above the part: {end:?}");
    }
    path
}

#[test]
fn covers_a_sphere() {
    let path = plan_and_check(&SPHERE, [0.0, 0.3, 1.0], [1.5, 1.0]);
    assert!(
        path.left_out.len() * 20 < path.contact_points,
        "{} of {}",
        path.left_out.len(),
        path.contact_points
    );
    // The tool rolls over the edges between triangles that meet at up to 10 degrees.
    assert!(
        path.retracts * 50 < path.contact_points,
        "{} of {}",
        path.retracts,
        path.contact_points
    );
    assert!(path.turns[1] < 0.8 * path.turns[0], "{:?}", path.turns);
}

#[test]
fn covers_a_block_with_a_step() {
    let diagnostics = STEP.mesh.diagnostics();
    assert!(diagnostics.is_solid(), "{:?}", diagnostics.findings());
    plan_and_check(&STEP, [0.0, 1.0, 0.0], [2.0, 1.0]);
}

#[test]
fn covers_an_open_sheet_and_a_bore() {
    plan_and_check(
        &Case::new(shapes::plane(10.0, 4, Unit::Millimetre).expect("a sheet"), &*MILL),
        [1.0, 0.0, 0.0],
        [1.0, 1.0],
    );
    let path = plan_and_check(
        &Case::new(shapes::tube(6.0, 12.0, 16.0, 24, 4, Unit::Millimetre).expect("a tube"), &*MILL),
        [0.0, 1.0, 0.0],
        [2.0, 1.5],
    );
    assert!(path.retracts > 0);
}

/// The stock is 3 mm larger than the part on all sides but the lowest. Rapid traverse has to leave
/// no trace in it: the oracle samples its surface, and locates the tips.
#[test]
fn rapid_traverse_keeps_clear_of_the_stock() {
    let case = &*STEP;
    let [low, high] = [Point3::new(-15.0, -13.0, 0.0), Point3::new(15.0, 13.0, 17.0)];
    let stock = shapes::cuboid(low, high, Unit::Millimetre).expect("a stock");
    let bvh = TriangleBvh::new(&stock);
    let pattern = Pattern { normal: [0.0, 1.0, 0.0], stepover: 2.0, step: 1.0 };
    let request = case.request(&*MILL, &pattern);
    let without = request.plan().expect("a path");
    let path = PathRequest { stock: Some(&bvh), ..request }.plan().expect("a path");
    let in_stock = |path: &ToolPath| {
        let [feed, rapid] = max_depths(&stock, path);
        let stops = path.locations.windows(2).filter(|pair| pair[1].1);
        let tips = stops.flat_map(|pair| [pair[0].0.tip(), pair[1].0.tip()]);
        let inside = tips.filter(|tip| (0..3).all(|k| low[k] < tip[k] && tip[k] < high[k]));
        (feed[0], rapid[0].max(rapid[1]), inside.count())
    };
    let ((feed, rapid, inside), (_, other_rapid, other_inside)) =
        (in_stock(&path), in_stock(&without));
    println!(
        "in the stock: {feed} in feed, {rapid} in rapid traverse, {inside} tips; without it {other_rapid}, {other_inside}"
    );
    assert!(feed > 1.0 && other_rapid > 1.0 && other_inside > 0);
    assert!(rapid < 1e-9 && inside == 0, "{rapid}, {inside}");
    let [feed, rapid] = max_depths(&case.mesh, &path);
    assert!(feed[0].max(rapid[0]) <= TOLERANCE + 1e-9, "{feed:?} {rapid:?}");
    // The stock hides no point from the tool.
    assert_eq!(path.contact_points, without.contact_points);
}

#[test]
fn paths_are_reproducible_in_every_unit_and_position() {
    let plan_on_sphere = |scale: f64, unit: Unit, offset: f64| {
        let mesh = sphere();
        let vertices =
            mesh.vertices().iter().map(|vertex| vertex * scale + Vector3::repeat(offset));
        let mesh = Mesh::new(vertices, mesh.triangles().to_vec(), unit).expect("a mesh");
        let case = Case::new(mesh, &*MILL);
        let path = case.plan_over_planes(&*MILL, [0.0, 0.0, 1.0], [4.0, 2.0]);
        let [feed, rapid] = max_depths(&case.mesh, &path);
        let rounding = 1e-9 + 1e-13 * offset;
        let max_depth = feed.into_iter().chain(rapid).fold(0.0, f64::max);
        assert!(max_depth <= TOLERANCE + rounding, "{unit} at {offset}: {max_depth}");
        path
    };
    let first = plan_on_sphere(1.0, Unit::Millimetre, 0.0);
    assert_eq!(plan_on_sphere(1.0, Unit::Millimetre, 0.0).locations, first.locations);
    for (scale, unit, offset) in
        [(1.0 / 25.4, Unit::Inch, 0.0), (1e-3, Unit::Metre, 0.0), (1.0, Unit::Millimetre, 1e6)]
    {
        let path = plan_on_sphere(scale, unit, offset);
        let ratio = path.contact_points as f64 / first.contact_points as f64;
        assert!(
            (0.9..1.1).contains(&ratio),
            "{unit} at {offset}: {} of {}",
            path.contact_points,
            first.contact_points
        );
    }
}

#[test]
fn rejects_invalid_patterns() {
    let case = &*SPHERE;
    let pattern = Pattern { normal: [0.0, 0.0, 1.0], stepover: 2.0, step: 1.0 };
    let error_of = |pattern: Pattern| case.plan(&*MILL, &pattern).expect_err("no path");
    for invalid in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let error = error_of(Pattern { stepover: invalid, ..pattern });
        assert!(matches!(error, PathError::Pattern { what: "a stepover", .. }), "{error}");
        let error = error_of(Pattern { step: invalid, ..pattern });
        assert!(matches!(error, PathError::Pattern { what: "a step", .. }), "{error}");
    }
    for normal in [[0.0; 3], [f64::NAN, 0.0, 1.0], [f64::INFINITY, 0.0, 0.0]] {
        assert_eq!(error_of(Pattern { normal, ..pattern }), PathError::Normal);
    }
    for stepover in [1e-6, 1e-300] {
        let error = error_of(Pattern { stepover, ..pattern });
        assert!(matches!(error, PathError::TooMany { .. }), "{error}");
    }
    for (stepover, step) in [(2.0, 1e-9), (2.0, 1e-300), (1e9, 1e-9)] {
        let error = error_of(Pattern { stepover, step, ..pattern });
        assert!(matches!(error, PathError::TooFine { .. }), "{error}");
    }
    // One plane, and one point on a line, are enough.
    for large in [1e3, 1e300] {
        let path = case.plan(&*MILL, &Pattern { stepover: large, step: large, ..pattern });
        assert!(path.expect("a path").contact_points > 0);
    }
    // The normal may have any length.
    for size in [1e-300, 1e300] {
        let path =
            case.plan(&*MILL, &Pattern { normal: [0.0, 0.0, size], ..pattern }).expect("a path");
        assert_eq!(
            path.locations,
            case.plan(&*MILL, &pattern).expect("a path").locations,
            "{size}"
        );
    }
    let empty = vec![Vec::new(); case.access.len()];
    for access in [&empty[..], &[], &vec![vec![0; 4]; case.access.len()]] {
        let result = PathRequest { accessibility: access, ..case.request(&*MILL, &pattern) }.plan();
        assert_eq!(result.expect_err("no path"), PathError::NoPosture);
    }
    let invalid_rules = Rules { tolerance: 0.0, ..case.rules.clone() };
    let result = PathRequest { rules: &invalid_rules, ..case.request(&*MILL, &pattern) }.plan();
    assert!(matches!(result, Err(PathError::Validator(_))));
}

#[test]
fn covers_a_single_triangle() {
    let corners = [[0.0, 0.0, 0.0], [9.0, 0.0, 0.0], [0.0, 9.0, 0.0]].map(Point3::from);
    let mesh = Mesh::new(corners.to_vec(), vec![[0, 1, 2]], Unit::Millimetre).expect("a mesh");
    let case = Case::new(mesh, &*MILL);
    let path = case.plan_over_planes(&*MILL, [1.0, 0.0, 0.0], [1.0, 1.0]);
    assert_eq!(path.left_out.len(), 0);
    // Planes parallel to the triangle do not cut it.
    let flat = Pattern { normal: [0.0, 0.0, 1.0], stepover: 1.0, step: 1.0 };
    assert_eq!(case.plan(&*MILL, &flat).expect_err("no path"), PathError::NoPosture);
}

#[test]
fn a_tool_larger_than_the_part_reaches_it() {
    let case = Case::new(sphere(), &*WIDE);
    assert!(case.access.iter().flatten().any(|word| *word != 0));
    let path = case.plan_over_planes(&*WIDE, [0.0, 0.0, 1.0], [4.0, 2.0]);
    // Five circles of 250 mm together, with a point every 2 mm.
    assert!(
        path.contact_points >= 120 && path.left_out.is_empty(),
        "{} of {}",
        path.left_out.len(),
        path.contact_points
    );
}

#[test]
fn no_axis_exceeds_the_largest_tilt() {
    let case = &*SPHERE;
    let pattern = Pattern { normal: [0.0, 0.3, 1.0], stepover: 2.0, step: 1.0 };
    let plan = |max_tilt: f64| PathRequest { max_tilt, ..case.request(&*MILL, &pattern) }.plan();
    let lowest = |path: &ToolPath| {
        // Between two axes the lowest lies on their great circle.
        let pairs = path.locations.windows(2);
        let axes = pairs.flat_map(|pair| {
            let [from, to] = [pair[0].0.axis(), pair[1].0.axis()];
            (0..=20).map(move |k| from.slerp(&to, f64::from(k) / 20.0).z)
        });
        axes.fold(1.0, f64::min)
    };
    let unreached_by = |path: &ToolPath| path.count_left_out(LeftOutReason::NotReached);
    let free = plan(PI).expect("a path");
    assert!(lowest(&free) < -0.9, "a sphere is reached from below: {}", lowest(&free));
    let mut unreached = 0;
    for degrees in [120.0f64, 90.0, 45.0] {
        let tilted = plan(degrees.to_radians()).expect("a path");
        let [feed, rapid] = max_depths(&case.mesh, &tilted);
        let max_depth = feed.into_iter().chain(rapid).fold(0.0, f64::max);
        println!(
            "{degrees}: {} contact points, {} unreached, {} unlinked, lowest axis {}",
            tilted.contact_points,
            unreached_by(&tilted),
            tilted.count_left_out(LeftOutReason::NoMotion),
            lowest(&tilted)
        );
        assert!(max_depth <= TOLERANCE + 1e-9, "{max_depth}");
        assert!(lowest(&tilted) >= degrees.to_radians().cos() - 1e-9, "{degrees}");
        assert_eq!(
            tilted.contact_points + tilted.left_out.len(),
            free.contact_points + free.left_out.len()
        );
        unreached = unreached_by(&tilted);
    }
    assert!(unreached > unreached_by(&free) + 50, "some points need a larger tilt: {unreached}");
    for invalid in [0.0, -1.0, 4.0, f64::NAN, f64::INFINITY] {
        let error = plan(invalid).expect_err("no limit");
        assert!(matches!(error, PathError::Tilt(_)), "{error}");
    }
}

/// Axes as a trunnion that leans to one side reaches them.
struct Trunnion;

impl ToolAxisLimits for Trunnion {
    fn allow(&self, axis: &Vector3<f64>) -> bool {
        axis.x.abs() < 0.8 && (-0.5..=1.6).contains(&axis.y.atan2(axis.z))
    }
}

/// A machine that does not tilt.
struct ThreeAxes;

impl ToolAxisLimits for ThreeAxes {
    fn allow(&self, axis: &Vector3<f64>) -> bool {
        *axis == Vector3::z()
    }
}

#[test]
fn all_axes_are_within_the_limits_of_a_machine() {
    let case = &*STEP;
    let pattern = Pattern { normal: [0.0, 1.0, 0.0], stepover: 2.0, step: 1.0 };
    let plan = |axis_limits| PathRequest { axis_limits, ..case.request(&*MILL, &pattern) }.plan();
    let [free, limited] = [None, Some(&Trunnion as &dyn ToolAxisLimits)].map(|limits| {
        let path = plan(limits).expect("a path");
        let outside = path.locations.windows(2).filter(|pair| {
            let [from, to] = [pair[0].0.axis(), pair[1].0.axis()];
            (0..=20).any(|k| !Trunnion.allow(&from.slerp(&to, f64::from(k) / 20.0)))
        });
        println!("{} contact points, {} outside", path.contact_points, outside.clone().count());
        (path.contact_points, outside.count())
    });
    assert!(free.1 > 50 && limited.1 == 0, "{free:?} {limited:?}");
    // The step is reached from the side to which the trunnion leans, and from above.
    assert!(limited.0 * 3 > free.0, "{free:?} {limited:?}");
    assert_eq!(plan(Some(&ThreeAxes)).expect_err("no direction"), PathError::NoDirection);
}
