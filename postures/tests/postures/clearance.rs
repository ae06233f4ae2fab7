//! Distances between surfaces of a tool and a part, compared with a fine raster of its triangles.

use crate::{
    BALL, HOLDER, MILL, NECK, PLAIN, cutting_distance, is_inside, polyline_distance,
    random_numbers, random_pose,
};
use crate::{parts, sample_points, surface};
use nalgebra::{Point3, Vector3};
use touchoff::certify::{Certifier, TriangleBvh};
use touchoff::mesh::shapes;
use touchoff::{Interval, Pose, SurfaceId, Unit};

#[test]
fn clearances_agree_with_sample_points() {
    let mut random = random_numbers(1);
    let names: [&[&str]; 3] = [&["holder"], &["neck"], &["neck", "holder"]];
    let (mut clear, mut touching) = (0, 0);
    for mesh in parts() {
        let bvh = TriangleBvh::new(&mesh);
        let mut certifier = Certifier::new(&bvh, &*MILL).expect("a profile");
        for _ in 0..60 {
            let pose = random_pose(&mut random, 30.0);
            let (points, spacing) = sample_points(&mesh, &pose);
            for names in names {
                let distance = |point: [f64; 2]| {
                    let lines = [("neck", &NECK[..]), ("holder", &HOLDER[..])];
                    let requested = lines.iter().filter(|(name, _)| names.contains(name));
                    requested
                        .map(|(_, line)| polyline_distance(line, point))
                        .fold(f64::INFINITY, f64::min)
                };
                let surfaces: Vec<SurfaceId> =
                    names.iter().map(|name| surface(&*MILL, name)).collect();
                let clearance = certifier.clearance_of(&surfaces, &pose, 1e-6);
                let Interval { low, high } = clearance.expect("a surface of the tool").distance;
                let nearest =
                    points.iter().map(|point| distance(*point)).fold(f64::INFINITY, f64::min);
                let text = format!("{names:?} at {pose:?}: {nearest} by places, {low} to {high}");
                assert!(0.0 <= low && low <= high && high.is_finite(), "{text}");
                // A point inside the tool that is nearest to these surfaces is at distance 0.
                let other_distance = |point: [f64; 2]| {
                    let lines = [("neck", &NECK[..]), ("holder", &HOLDER[..])];
                    let others = lines.iter().filter(|(name, _)| !names.contains(name));
                    others
                        .map(|(_, line)| polyline_distance(line, point))
                        .fold(cutting_distance(point), f64::min)
                };
                let is_nearest = |point: &&[f64; 2]| {
                    is_inside(**point) && distance(**point) < other_distance(**point) - 1e-9
                };
                if points.iter().find(is_nearest).is_some() {
                    assert_eq!([low, high], [0.0; 2], "{text}");
                    touching += 1;
                    continue;
                }
                assert!(low <= nearest + 1e-9, "{text}");
                if low > 0.0 {
                    // No point of a triangle is farther from a raster point than a side of the raster.
                    assert!(nearest - spacing <= high, "{text}");
                    assert!(high - low < 2e-6, "{text}");
                    clear += 1;
                }
            }
        }
    }
    assert!(clear > 100 && touching > 20, "{clear} clear, {touching} touching");
}

#[test]
fn clearance_above_a_plate_is_the_height_of_each_surface() {
    let (low, high) = (Point3::new(-50.0, -50.0, -9.0), Point3::new(50.0, 50.0, 0.0));
    let bvh = TriangleBvh::new(&shapes::cuboid(low, high, Unit::Millimetre).expect("a plate"));
    let mut certifier = Certifier::new(&bvh, &*MILL).expect("a profile");
    let [neck, holder] = ["neck", "holder"].map(|name| surface(&*MILL, name));
    for (tip, to_neck, to_holder) in
        [(1.0, 13.0, 21.0), (-0.5, 11.5, 19.5), (-12.0, 0.0, 8.0), (-25.0, 0.0, 0.0)]
    {
        let pose = Pose::from_axis(Point3::new(0.0, 0.0, tip), Vector3::z()).expect("a pose");
        for (surfaces, expected) in
            [(vec![neck], to_neck), (vec![holder], to_holder), (vec![neck, holder], to_neck)]
        {
            let Interval { low, high } = certifier
                .clearance_of(&surfaces, &pose, 1e-9)
                .expect("a surface of the tool")
                .distance;
            let text = format!("{surfaces:?} at {tip}: {low} to {high}, not {expected}");
            assert!(low <= expected && expected <= high + 1e-9 && high - low < 1e-8, "{text}");
        }
        let Interval { low, high } = certifier
            .clearance_of(&[SurfaceId(0), SurfaceId(1), neck, holder], &pose, 1e-9)
            .expect("a surface of the tool")
            .distance;
        let whole = certifier.clearance(&pose, 1e-9).distance;
        assert!(low <= whole.high && whole.low <= high, "{low} to {high}, {whole:?}");
    }
}

#[test]
fn clearance_of_no_surface_is_infinite_and_without_a_profile_that_of_the_tool() {
    let bvh = TriangleBvh::new(&parts()[0]);
    let pose = Pose::from_axis(Point3::new(0.0, 0.0, 5.0), Vector3::z()).expect("a pose");
    let mut certifier = Certifier::new(&bvh, &*BALL).expect("a profile");
    let none = certifier.clearance_of(&[], &pose, 0.0).expect("no surface");
    assert_eq!(none.distance.low, f64::INFINITY);
    let mut certifier = Certifier::new(&bvh, &*PLAIN).expect("a depth that is known");
    let Interval { low, high } = certifier
        .clearance_of(&[SurfaceId(0)], &pose, 1e-6)
        .expect("a surface of the tool")
        .distance;
    assert!(low > 4.9 && low <= 5.0 && high == f64::INFINITY, "{low} to {high}");
}
