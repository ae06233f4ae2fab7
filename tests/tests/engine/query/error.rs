//! The error bounds that a probe states, against the depth of the points that were given.

use nalgebra::{Point3, Vector3};
use touchoff::TriangleId;
use touchoff::{Cloud, Interval, Part, Pose, Probe};
use touchoff_tests::oracle::big::Big;
use touchoff_tests::oracle::reference::{QueryPoint, Reference};
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
