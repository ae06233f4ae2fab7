//! The error bounds that a probe states, against the depth of the points that were given.

use super::{parts, poses};
use nalgebra::{Point3, Vector3};
use touchoff::TriangleId;
use touchoff::tool::{Interpreted, Tool};
use touchoff::{Cloud, Interval, Part, Pose, Probe};
use touchoff_tests::oracle::big::Big;
use touchoff_tests::oracle::exact::{Frame, exactly};
use touchoff_tests::oracle::profile::Profile;
use touchoff_tests::oracle::reference::{QueryPoint, Reference};
use touchoff_tests::oracle::restated::Restated;
use touchoff_tests::oracle::rng::Rng;
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
        let cloud = Cloud::new(
            points.clone(),
            vec![Vector3::z(); count],
            (0..count as u32).map(TriangleId).collect(),
            vec![1.0; count],
            info.unit,
        )
        .expect("a cloud");
        let part = Part::from_cloud(&cloud);
        let mut probe = Probe::new(&part, tool);
        let stated = probe.rounding_error_bound().expect("the library's depths are bounded");
        let pose = Pose::from_axis(Point3::from(far), Vector3::z()).expect("a pose");
        let mut worst = 0.0f64;
        for contact in probe.contacts(&pose) {
            let given = points[contact.triangle.index()] - far;
            let at = [given.x, given.y, given.z];
            let exact = reference.depth(&QueryPoint::new(at));
            worst = worst.max((&Big::exactly(contact.depth) - &exact).abs().to_f64());
        }
        assert!(worst <= stated, "{}: {worst:e} over {stated:e}", info.name);
        tightest = tightest.min(stated / worst);
    }
    // The bound is that of the worst leaf and the steepest place, but not an idle one.
    assert!(tightest < 20.0, "{tightest}");
}

/// A part of one point is stored to the last bit, so that only the transform and the depth are rounded: that of a long pin
/// hardly, that beside an arc of a large circle by much.
#[test]
fn depths_of_points_that_are_stored_exactly_keep_the_bound() {
    let mut rng = Rng::new(5);
    for (profile, within) in [
        ("0 0, 4 0, 4 32, 0 32", [[0.0, 4.0], [31.0, 32.0]]),
        ("0 0, 6 0, 6 16 about -524281.999969482421875 8, 0 16", [[5.0, 6.0], [1.5, 14.5]]),
    ] {
        let drawn =
            Profile::<f64>::parse(profile).text(f64::to_string, |k| format!("s{k} cutting"));
        let text = format!("tool Turned {{ units mm; {drawn} niceness cutting: 1; }}");
        let tool: Interpreted = text.parse().expect("a tool");
        let reference = Reference::new(&Restated::of_profile("Turned", &Profile::parse(profile)));
        let mut largest = 0.0f64;
        for _ in 0..400 {
            let [d, z] = within.map(|[low, high]| rng.between(low, high));
            let [cos, sin] = rng.azimuth();
            let at = Point3::from(10.0 * parts::direction(&mut rng));
            let pose = poses::bringing(Vector3::new(d * cos, d * sin, z), at, &mut rng);
            let part = parts::identical(at, 1);
            let mut probe = Probe::new(&part, &tool);
            let stated = probe.rounding_error_bound().expect("its depth is bounded");
            let found = probe.deepest(&pose).expect("a point inside").depth;
            let own = Frame::new(pose.rotation(), pose.tip()).to_tool(&exactly(at));
            let exact = reference.depth(&QueryPoint::of(own));
            let error = (&Big::exactly(found) - &exact).abs().to_f64();
            assert!(error <= stated, "{error:e} over {stated:e} at {pose:?}");
            largest = largest.max(error / stated);
        }
        println!("{largest} of the bound, {:?}", tool.info().depth);
    }
}
