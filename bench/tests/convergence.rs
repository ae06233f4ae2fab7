//! How what is felt of clouds nears what is felt of the surface: a sample of `docs/measured/convergence.md`.

use nalgebra::Point3;
use touchoff::mesh::shapes;
use touchoff::{Cloud, Mesh, Unit, scenes};
use touchoff_bench::convergence::bounds::{self, Place};
use touchoff_bench::convergence::contact::Contact;
use touchoff_bench::convergence::errors::{Often, table};
use touchoff_bench::convergence::{Pattern, Weighing, equal, missed, radius};

const UNIT: Unit = Unit::Millimetre;

fn meshes() -> Vec<(&'static str, Mesh)> {
    let high = Point3::new(1.0, 2.0, 4.0);
    vec![
        ("tube", scenes::tube()),
        ("cuboid", shapes::cuboid(Point3::origin(), high, UNIT).expect("a box")),
        ("sphere", shapes::sphere(2.0, 4, UNIT).expect("a ball")),
        ("plane", shapes::plane(3.0, 2, UNIT).expect("a plane")),
    ]
}

#[test]
fn errors_fall_as_they_should() {
    let sizes = [19.0, 88.0, 400.0].map(|contacts| Often { contacts, clouds: 6, placements: 16 });
    for contact in [Contact::BallInPlane, Contact::SideInPlane, Contact::BallOnBall] {
        let table = table(contact, &sizes, 3);
        let name = contact.name();
        for row in &table.rows {
            let off = row.colliding / row.often.contacts - 1.0;
            assert!(off.abs() < 0.05, "{name}: {} in contact", row.colliding);
        }
        // Four times the points: half the error, and a sixth of it.
        for (pattern, weighing, [low, high]) in [
            (Pattern::Random, Weighing::Equal, [-0.7, -0.35]),
            (Pattern::Blue, Weighing::Equal, [-0.7, -0.35]),
            (Pattern::Random, Weighing::Cells, [-1.5, -1.05]),
            (Pattern::Blue, Weighing::Cells, [-1.6, -1.1]),
        ] {
            let [order, _] = table.force(pattern, weighing);
            println!("{name} {pattern:?} {weighing:?}: {order:.2}");
            assert!((low..high).contains(&order), "{name} {pattern:?} {weighing:?}: {order}");
            let [torque, _] = table.torque(pattern, weighing);
            let same = !contact.is_line() || (torque - order).abs() < 0.1;
            assert!(same, "{name} {pattern:?} {weighing:?}: {torque}");
        }
        let expected = if contact.is_line() { -2.0 } else { -1.0 };
        for pattern in Pattern::ALL {
            let [order, _] = table.depth(pattern);
            println!("{name} {pattern:?} depth: {order:.2}");
            assert!((order / expected - 1.0).abs() < 0.25, "{name} {pattern:?} depth: {order}");
        }
        // Weights matter more than the pattern, and both matter.
        let [[random, random_cells], [blue, blue_cells]] = table.rows[2].force;
        let falls = 2.0 * blue < random && 4.0 * random_cells < blue;
        assert!(falls && 2.0 * blue_cells < random_cells, "{name}: {:?}", table.rows[2]);
    }
}

#[test]
fn errors_are_those_of_the_prototype() {
    let size = Often { contacts: 152.0, clouds: 12, placements: 16 };
    let row = &table(Contact::BallInPlane, &[size], 4).rows[0];
    let expected = [[9.3e-2, 6.0e-3], [2.8e-2, 1.2e-3]];
    for (found, expected) in row.force.concat().into_iter().zip(expected.concat()) {
        assert!((0.7..1.3).contains(&(found / expected)), "{found:e} {expected:e}");
    }
}

#[test]
fn weights_are_the_area() {
    for (name, mesh) in meshes() {
        let area = mesh.survey().area;
        for pattern in Pattern::ALL {
            for count in [1, 2, 3, 50, 3000] {
                let cloud = pattern.cloud(&mesh, count, 5);
                assert_eq!(cloud.len(), count, "{name}");
                for cloud in [&equal(&cloud, &mesh), &cloud] {
                    let sum: f64 = cloud.weights().iter().sum();
                    let off = (sum / area - 1.0).abs();
                    assert!(off < 1e-12, "{name} {pattern:?} {count}: {off:e}");
                }
            }
        }
    }
}

/// Of a dense cloud no point is farther than ε from a sparse one, and one is nearly as far.
#[test]
fn the_covering_radius_covers() {
    for (name, mesh) in meshes() {
        let places = Cloud::random(&mesh, 20_000, 8).expect("a cloud");
        for pattern in Pattern::ALL {
            let cloud = pattern.cloud(&mesh, 200, 6);
            let nearest = |place: &Point3<f64>| {
                let far = cloud.points().iter().map(|point| (point - place).norm_squared());
                far.fold(f64::INFINITY, f64::min).sqrt()
            };
            let farthest = places.points().iter().map(nearest).fold(0.0, f64::max);
            let radius = radius(&cloud);
            let share = farthest / radius;
            println!("{name} {pattern:?}: {share}");
            assert!((0.9..=1.0 + 1e-12).contains(&share), "{name} {pattern:?}: {share}");
        }
    }
}

#[test]
fn the_covering_radius_keeps_its_promises() {
    for place in Place::ALL {
        for pattern in Pattern::ALL {
            let row = bounds::row(place, pattern, 2, 1_000, 7);
            assert!(row.radius < 1.0, "{row:?}");
            assert_eq!((row.beyond, row.too_deep), (0, 0), "{row:?}");
            // Beside a convex edge the bound of the plane is none.
            let convex = place == Place::Outside;
            assert_eq!(row.beyond_flat > 0, convex, "{row:?}");
            assert!((0.5..=1.0).contains(&row.most), "{row:?}");
        }
    }
}

#[test]
fn shallow_contacts_are_missed_as_often_as_expected() {
    for row in missed::rows(4, 2_000, 10) {
        let [random, blue] = row.missed;
        assert!((random - row.random()).abs() < 0.02, "{row:?}");
        // The shallowest discs are too small for any pattern to help.
        let most = if row.depth < 0.005 { random + 0.02 } else { random };
        assert!(blue <= most && blue > row.least() - 0.02, "{row:?}");
    }
}
