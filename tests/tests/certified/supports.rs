//! Distances of convex tools inside a convex part. The part's surface is as far away as the nearest plane of a face is
//! from the tool, along the face's normal: the difference of the support functions of both.

use crate::prelude::*;

const SIZE: f64 = 20.0;

/// A convex tool, and what of it reaches farthest in some direction.
struct Convex {
    tool: Interpreted,
    /// Circles of its surface, as radius and height.
    circles: &'static [[f64; 2]],
    /// Balls about points of the axis, as radius and height of the centre.
    balls: &'static [[f64; 2]],
    /// True if the distance is known from both sides.
    is_exact: bool,
}

/// A tool without a profile: a ball below a cylinder.
pub(crate) const REGIONS: &str = "tool Regions { units mm;
    curve nose = hypot(d, z - 1) - 1; curve side = 1 - d; curve end = 6 - z;
    region ball as ball cutting where z <= 1, nose <= 0 { depth: -nose; }
    region shank where z >= 1, 0 <= side <= end { depth: side; }
    region end as shank where 0 <= end <= side { depth: end; }
    niceness cutting: 1; }";

fn tools() -> [Convex; 4] {
    let profile = |drawing, circles, balls| Convex {
        tool: drawn(drawing, ""),
        circles,
        balls,
        is_exact: true,
    };
    [
        profile("0 0; ball 0 6 about 0 3", &[], &[[3.0, 3.0]]),
        profile("0 0; face 2 0; side 2 5, 0 5", &[[2.0, 0.0], [2.0, 5.0]], &[]),
        profile(
            "0 0; nose 1 1 about 0 1; side 1 3, 2 6, 0 6",
            &[[1.0, 1.0], [2.0, 6.0]],
            &[[1.0, 1.0]],
        ),
        Convex {
            tool: REGIONS.parse().expect("a tool"),
            circles: &[[1.0, 1.0], [1.0, 6.0]],
            balls: &[[1.0, 1.0]],
            is_exact: false,
        },
    ]
}

impl Convex {
    /// Returns how far the tool reaches in a direction of the world, a unit vector.
    fn support(&self, pose: &Pose, direction: Vector3<f64>) -> f64 {
        let up = direction.dot(&pose.axis());
        let out = (1.0 - up * up).max(0.0).sqrt();
        let circles = self.circles.iter().map(|[radius, height]| radius * out + height * up);
        // The upper half of a ball may be inside the tool, and reaches no farther than the tool then.
        let balls = self.balls.iter().map(|[radius, height]| radius + height * up);
        direction.dot(&pose.tip().coords) + circles.chain(balls).fold(f64::NEG_INFINITY, f64::max)
    }

    fn distance(&self, mesh: &Mesh, pose: &Pose) -> f64 {
        let faces = (0..mesh.triangles().len() as u32).map(TriangleId);
        let gaps = faces.map(|id| {
            let normal = mesh.normal(id).expect("it has an area");
            normal.dot(&mesh.triangle(id)[0].coords) - self.support(pose, normal)
        });
        gaps.fold(f64::INFINITY, f64::min)
    }
}

#[test]
fn a_convex_tool_in_a_convex_part_is_as_far_as_the_nearest_face() {
    let mesh = shapes::sphere(SIZE, 2, Unit::Millimetre).expect("a sphere");
    for id in (0..mesh.triangles().len() as u32).map(TriangleId) {
        let (normal, base) = (mesh.normal(id).expect("it has an area"), mesh.triangle(id)[0]);
        assert!(mesh.vertices().iter().all(|p| normal.dot(&(p - base)) < 1e-12), "not convex");
    }
    let mut rng = Rng::new(1);
    for convex in tools() {
        let mut certifier = certifier_of(&mesh, &convex.tool);
        let mut count = 0;
        while count < if convex.is_exact { 60 } else { 6 } {
            let tip = Point3::from(rng.between(0.0, SIZE) * Vector3::from(rng.direction()));
            let pose = pose(tip.into(), rng.direction());
            let expected = convex.distance(&mesh, &pose);
            if expected < 1e-3 {
                continue;
            }
            count += 1;
            let found =
                certifier.clearance(&pose, if convex.is_exact { 1e-7 } else { 1e-2 }).distance;
            let circles = convex.circles;
            let text = format!("{circles:?}: {expected} in {found:?} at {pose:?}");
            assert!(found.low <= expected + 1e-12, "{text}");
            if convex.is_exact {
                assert!(expected - 1e-12 <= found.high && found.width() < 2e-7, "{text}");
            }
        }
    }
}
