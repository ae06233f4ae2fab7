//! The error bounds that a probe states, against the depth of the points that were given.

use super::parts;
use crate::prelude::*;
use touchoff::Interval;
use touchoff_tests::fixtures::{drawn, part_in};
use touchoff_tests::oracle::Meridian;
use touchoff_tests::oracle::big::Big;
use touchoff_tests::oracle::reference::Reference;
use touchoff_tests::oracle::space::{Frame, Triple, exactly};
use touchoff_tests::oracle::vector::norm;
use touchoff_tests::profiles::tools;

#[test]
fn depths_keep_the_stated_error_bound() {
    let mut rng = Rng::new(3);
    let mut tightest = f64::INFINITY;
    for (tool, restated) in tools() {
        let info = tool.info();
        // A depth that a file writes is not the distance that the reference measures.
        if !info.is_exact() {
            continue;
        }
        let reference = Reference::new(&restated);
        let Interval { low, high } = info.reach();
        // A box of points about the tool, each with a triangle id of its own, far from the world's origin.
        let far = Vector3::new(700.0, -300.0, 55.0);
        let count = 4_000;
        let within = |rng: &mut Rng| {
            let across = |rng: &mut Rng| rng.between(-info.radius(), info.radius());
            Point3::new(across(rng), across(rng), rng.between(low, high)) + far
        };
        let points: Vec<Point3<f64>> = (0..count).map(|_| within(&mut rng)).collect();
        let (normals, weights) = (vec![Vector3::z(); count], vec![1.0; count]);
        let part = part_in(info.unit, points.clone(), normals, weights);
        let mut probe = Probe::new(&part, tool);
        let stated = probe.rounding_error_bound().expect("the library's depths are bounded");
        let pose = Pose::from_axis(Point3::from(far), Vector3::z()).expect("a pose");
        let mut worst = 0.0f64;
        for contact in probe.contacts(&pose) {
            let given = points[contact.triangle.index()] - far;
            let at = [given.x, given.y, given.z];
            let exact = reference.depth(&Meridian::of(exactly(at)));
            worst = worst.max((&Big::exactly(contact.depth) - &exact).abs().to_f64());
        }
        assert!(worst <= stated, "{}: {worst:e} over {stated:e}", info.name);
        tightest = tightest.min(stated / worst);
    }
    // The bound is that of the worst leaf and the steepest place, but not an idle one.
    assert!(tightest < 20.0, "{tightest}");
}

/// A part of one point is stored to the last bit, so that only the transform and the depth are rounded: that of a long pin
/// hardly, that below a large sphere by much.
#[test]
fn depths_of_points_that_are_stored_exactly_keep_the_bound() {
    let pin = drawn("0 0; pin 4 0, 4 32, 0 32", "pin");
    let dish: Interpreted = "tool Dish { units mm;
            curve face = 1000000 - hypot(d, z - 1000000); curve side = 5 - d; curve end = 8 - z;
            region face as face cutting where 0 <= face <= side, face <= end { depth: face; }
            region side where 0 <= side <= face, side <= end { depth: side; }
            region end as side where 0 <= end <= face, end <= side { depth: end; }
            niceness cutting: 1; }"
        .parse()
        .expect("a tool");
    let below_top: fn(&Triple) -> Big = |[_, _, z]| &Big::exactly(32.0) - z;
    let above_face: fn(&Triple) -> Big = |[x, y, z]| {
        let from_centre = [x.clone(), y.clone(), z - &Big::exactly(1e6)];
        &Big::exactly(1e6) - &norm(&from_centre)
    };
    let mut rng = Rng::new(5);
    for (tool, heights, exact) in [(&pin, [31.0, 32.0], below_top), (&dish, [0.5, 1.5], above_face)]
    {
        for _ in 0..400 {
            let [x, y] = [0; 2].map(|_| rng.between(-2.0, 2.0));
            let own = Vector3::new(x, y, rng.between(heights[0], heights[1]));
            let at = Point3::from(10.0 * parts::direction(&mut rng));
            let pose = parts::bringing(own, at, &mut rng);
            let part = parts::identical(at, 1);
            let mut probe = Probe::new(&part, tool);
            let stated = probe.rounding_error_bound().expect("its depth is bounded");
            let found = probe.deepest(&pose).expect("a point inside").depth;
            let own = Frame::new(pose.rotation(), pose.tip()).to_tool(&exactly(at));
            let error = (&Big::exactly(found) - &exact(&own)).abs().to_f64();
            assert!(error <= stated, "{error:e} over {stated:e} at {pose:?}");
        }
    }
}
