//! Contacts of surfaces that must not touch material.

use super::*;
use nalgebra::Rotation3;
use touchoff::SurfaceId;
use touchoff::mesh::shapes;

const FLUTE: SurfaceId = SurfaceId(0);
const SHANK: SurfaceId = SurfaceId(1);

/// A block with its top at z = 0 and a wall at y = 0.
fn wall() -> Stock {
    block([0.0, 0.0, -20.0], [40.0, 20.0, 0.0], 0.5)
}

/// A program along the wall, lower from line to line: the flute stays clear of the wall by 0.1 mm, the
/// thicker shank would be 0.9 mm in it. It is above the block until the tip is below -8 mm.
#[test]
fn a_shank_that_rubs_is_found_at_its_line() {
    let mut stock = wall();
    let heights = [-4.0, -6.0, -8.0, -12.0, -12.0];
    let mut found = Vec::new();
    for (line, height) in heights.into_iter().enumerate() {
        let poses = [-10.0, 50.0].map(|x| upright([x, -3.1, height]));
        for contact in advance(&mut stock, &Reduced, poses, MotionMode::Feed, 0.05) {
            found.push((line, contact));
        }
    }
    let [(line, contact)] = found[..] else { panic!("{found:?}") };
    assert_eq!((line, contact.surface, contact.continued), (3, SHANK, false));
    // The first layer of points is 0.25 mm inside the wall. The shoulder is 4 mm below the top.
    let expected = 4.0 - 3.1 - 0.25;
    assert!(contact.depth <= expected + 1e-6 && contact.depth > expected - 1e-3, "{contact:?}");
    // Against the wall itself, whose points are up to 0.9 mm deep.
    let true_depth = 4.0 - 3.1;
    let resolution = stock.missed_ball_radius() + 0.5 * stock.step();
    assert!((contact.depth - true_depth).abs() < resolution);
    assert!((contact.point.y - 0.25).abs() < 1e-6 && contact.point.z > -4.0, "{contact:?}");
    let tip = -10.0 + 60.0 * contact.time;
    assert!((contact.point.x - tip).abs() < 0.1, "{contact:?}");
    // Two layers along the wall, 0.25 and 0.75 mm deep in the block, and 4 mm high.
    assert_eq!(contact.points, 2 * 80 * 8);
    assert_eq!(stock.initial_len() - stock.len(), contact.points);
}

/// The depth of a contact does not depend on the way in which a path is divided, and a contact that goes on
/// is marked.
#[test]
fn divided_motions_find_the_same_contact() {
    let pose = |x: f64| upright([x, -3.1, -12.0]);
    let mut stock = wall();
    let poses = [-10.0, 50.0].map(pose);
    let whole = advance(&mut stock, &Reduced, poses, MotionMode::Feed, 0.05);
    let [whole] = whole[..] else { panic!("{whole:?}") };
    for parts in [2u32, 10, 1000] {
        let mut divided = wall();
        let mut found = Vec::new();
        for part in 0..parts {
            let x = |part: u32| -10.0 + 60.0 * f64::from(part) / f64::from(parts);
            let poses = [part, part + 1].map(|part| pose(x(part)));
            found.extend(advance(&mut divided, &Reduced, poses, MotionMode::Feed, 0.05));
        }
        assert_eq!(found.iter().filter(|contact| !contact.continued).count(), 1, "{parts}");
        assert!(!found[0].continued);
        assert_eq!(found.iter().map(|contact| contact.points).sum::<usize>(), whole.points);
        let deepest = found.iter().map(|contact| contact.depth).fold(0.0, f64::max);
        assert!((deepest - whole.depth).abs() < 1e-3, "{deepest} {whole:?}");
        assert_eq!(divided.remaining(), stock.remaining());
    }
}

#[test]
fn a_rapid_motion_through_material_is_found_once() {
    let mut stock = wall();
    let poses = [-10.0, 50.0].map(|x| upright([x, 10.0, -5.0]));
    let found = advance(&mut stock, &Mill, poses, MotionMode::Rapid, 0.01);
    let [contact] = found[..] else { panic!("{found:?}") };
    assert_eq!((contact.surface, contact.continued), (FLUTE, false));
    // The axis passes between two rows of points, 0.25 mm from each.
    assert!(
        (contact.depth - 2.75).abs() < 1e-2 && contact.points == stock.initial_len() - stock.len()
    );
    assert!(contact.time > 1.0 / 6.0 && contact.time < 5.0 / 6.0, "{contact:?}");
    // The material in the way is gone, and so is its contact.
    for mode in [MotionMode::Rapid, MotionMode::Feed] {
        assert_eq!(advance(&mut stock, &Mill, poses, mode, 0.01), []);
    }
}

/// A tool in feed touches nothing where it has cut before, in rapid traverse either: it leaves as it came.
#[test]
fn a_rapid_motion_out_of_a_cut_is_clear() {
    for tip in [[20.0, 10.0, -6.0], [13.0, -1.0, -9.0]] {
        let mut stock = wall();
        let [above, down] = [[tip[0], tip[1], 5.0], tip].map(upright);
        let side = upright([tip[0] + 9.0, tip[1], tip[2]]);
        for (poses, mode) in [
            ([above, down], MotionMode::Feed),
            ([down, side], MotionMode::Feed),
            ([side, down], MotionMode::Rapid),
            ([down, above], MotionMode::Rapid),
        ] {
            assert_eq!(advance(&mut stock, &Mill, poses, mode, 1e-3), []);
        }
    }
}

/// Points within the tolerance are no contact, and stay.
#[test]
fn points_within_the_tolerance_stay() {
    let mut stock = wall();
    // 0.15 mm in the first layer of points.
    let poses = [-10.0, 50.0].map(|x| upright([x, -2.6, 2.0]));
    let lower = [-10.0, 50.0].map(|x| upright([x, -2.6, -4.0]));
    assert_eq!(advance(&mut stock, &Mill, poses, MotionMode::Rapid, 0.2), []);
    assert_eq!(advance(&mut stock, &Mill, lower, MotionMode::Rapid, 0.2), []);
    assert_eq!(stock.len(), stock.initial_len());
    let found = advance(&mut stock, &Mill, lower, MotionMode::Rapid, 0.1);
    let [contact] = found[..] else { panic!("{found:?}") };
    assert!((contact.depth - 0.15).abs() < 1e-3, "{contact:?}");
    assert_eq!(contact.points, 80 * 8);
    assert_eq!(stock.initial_len() - stock.len(), 80 * 8);
}

/// A tool that rests in material reports it once; it is left where it is until the tool has gone or is
/// changed.
#[test]
fn contacts_end_when_the_tool_leaves_or_changes() {
    let inside = upright([20.0, 10.0, -5.0]);
    let above = upright([20.0, 10.0, 5.0]);
    for changed in [false, true] {
        let mut stock = wall();
        let found = advance(&mut stock, &Mill, [inside; 2], MotionMode::Rapid, 0.01);
        let [contact] = found[..] else { panic!("{found:?}") };
        assert_eq!((contact.time, stock.len()), (0.0, stock.initial_len()));
        assert_eq!(advance(&mut stock, &Mill, [inside; 2], MotionMode::Rapid, 0.01), []);
        assert_eq!(stock.len(), stock.initial_len());
        if changed {
            let outside = upright([200.0, 0.0, 0.0]);
            assert_eq!(advance(&mut stock, &Ball, [outside; 2], MotionMode::Feed, 0.01), []);
        } else {
            assert_eq!(advance(&mut stock, &Mill, [inside, above], MotionMode::Rapid, 0.01), []);
        }
        assert_eq!(stock.initial_len() - stock.len(), contact.points);
    }
}

/// The two surfaces of a tool are reported separately, in their order.
#[test]
fn each_surface_has_its_contact() {
    let mut stock = wall();
    let poses = [-10.0, 50.0].map(|x| upright([x, 10.0, -15.0]));
    let found = advance(&mut stock, &Mill, poses, MotionMode::Rapid, 0.01);
    let [flute, shank] = found[..] else { panic!("{found:?}") };
    assert_eq!((flute.surface, shank.surface), (FLUTE, SHANK));
    assert!(flute.point.z < -5.0 && shank.point.z > -5.0);
    let mut stock = wall();
    let found = advance(&mut stock, &Mill, poses, MotionMode::Feed, 0.01);
    let [shank] = found[..] else { panic!("{found:?}") };
    // The flute cuts its 10 mm, and the shank presses into the 5 mm above.
    assert_eq!(shank.surface, SHANK);
    assert_eq!((shank.points, stock.initial_len() - stock.len()), (80 * 12 * 10, 80 * 12 * 30));
}

/// A tool in inches cuts and touches the same points as the same tool in millimetres, at the same depths.
#[test]
fn units_are_converted() {
    touchoff::tool! {
        tool InchMill "the mill in inches" {
            units inch;
            let mm = 1/25.4;
            profile {
                start (0, 0);
                line to (3*mm, 0), (3*mm, 10*mm) as flute cutting;
                line to (3*mm, 30*mm), (0, 30*mm) as shank;
            }
            niceness cutting: 1;
        }
    }
    let poses = [[-10.0, 9.9, -15.0], [50.0, 10.1, -14.0]].map(upright);
    let run = |tool: &dyn Tool| {
        let mut stock = wall();
        (advance(&mut stock, tool, poses, MotionMode::Feed, 0.01), stock.remaining())
    };
    let ((mm, remaining), (inch, remaining_of_inch)) = (run(&Mill), run(&InchMill));
    assert_eq!(remaining, remaining_of_inch);
    let ([mm], [inch]) = (&mm[..], &inch[..]) else { panic!("{mm:?} {inch:?}") };
    assert!((mm.depth - inch.depth).abs() < 1e-9 && mm.points == inch.points, "{mm:?} {inch:?}");
}

#[test]
fn what_is_no_motion_is_refused() {
    let mut stock = wall();
    let pose = |_: f64| upright([20.0, 10.0, -5.0]);
    let mut refused = |travel: f64, tolerance: f64| {
        stock.advance(&Mill, &pose, travel, MotionMode::Feed, tolerance).expect_err("refused")
    };
    for travel in [-1.0, f64::NAN, f64::INFINITY, 1e300] {
        assert!(matches!(refused(travel, 0.0), StockError::Travel { .. }));
    }
    for tolerance in [-1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(refused(1.0, tolerance), StockError::Tolerance { .. }));
    }
    assert_eq!(stock.len(), stock.initial_len());
    touchoff::tool! {
        solid Block "a block" {
            units mm;
            curve inside = min(3 - abs(x), 3 - abs(y), z, 3 - z);
            region block as block cutting where inside >= 0 { depth: inside; }
            niceness cutting: 1;
        }
    }
    let refused = stock.advance(&Block, &pose, 1.0, MotionMode::Feed, 0.0).expect_err("no spin");
    assert_eq!(refused, StockError::NoSpin { solid: "Block".to_owned() });
    let turned = Pose::from_quaternion(Point3::new(20.0, 10.0, -3.0), [0.0, 0.0, 0.0, 1.0]);
    let turned = turned.expect("a pose");
    let cut = stock.advance(&Block, &|_| turned, 0.0, MotionMode::Feed, 0.0).expect("cut");
    assert_eq!((cut.len(), stock.initial_len() - stock.len()), (0, 12 * 12 * 6));
}

/// A layer is found from the thickness that is stated, however the points lie in it.
#[test]
fn a_layer_of_the_stated_thickness_is_found() {
    let flat = block([-10.0, -10.0, -8.0], [10.0, 10.0, 0.0], 1.0);
    let tolerance = flat.step();
    assert!((flat.found_layer(tolerance) - (3f64.sqrt() + 0.25 + 0.125)).abs() < 1e-6);
    let mesh = shapes::cuboid([-10.0, -10.0, -8.0].into(), [10.0, 10.0, 0.0].into(), UNIT);
    let mesh = mesh.expect("a block");
    let mut below = 0;
    for k in 0..60 {
        let turn = f64::from(k) * 0.37;
        let rotation = Rotation3::from_euler_angles(turn, 0.61 * turn, 0.29 * turn);
        let shift = Vector3::new(0.13, 0.29, 0.41) * f64::from(k);
        let place = |point: Point3<f64>| rotation * point + shift;
        let vertices = mesh.vertices().iter().map(|vertex| place(*vertex));
        let turned = Mesh::new(vertices, mesh.triangles().to_vec(), UNIT).expect("a block");
        let found = |depth: f64| {
            let mut stock = Stock::from_mesh(&turned, 1.0).expect("a stock");
            let pose = |x: f64| {
                let tip = place(Point3::new(x, 0.0, -depth));
                Pose::from_axis(tip, rotation * Vector3::z()).expect("a pose")
            };
            let poses = [pose(-6.0), pose(6.0)];
            !advance(&mut stock, &Mill, poses, MotionMode::Rapid, tolerance).is_empty()
        };
        assert!(found(flat.found_layer(tolerance)), "turn {k}");
        below += u32::from(!found(tolerance + 0.05));
    }
    assert!(below > 0, "thinner layers can be missed");
}

/// A wide tool finds the layer of the stock; a neck leaves one as thick as its length and the balls beside it.
#[test]
fn a_neck_makes_the_layer_that_is_found_thicker() {
    touchoff::tool! {
        tool Necked "a neck of 1 mm" {
            units mm;
            profile {
                start (0, 0);
                line to (6, 0), (6, 5) as disc cutting;
                line to (0.5, 5), (0.5, 20) as neck;
                line to (6, 20), (6, 40), (0, 40) as shank;
            }
        }
    }
    touchoff::tool! {
        tool Pin "1 mm" {
            units mm;
            profile { start (0, 0); line to (0.5, 0), (0.5, 40), (0, 40) as pin cutting; }
        }
    }
    let stock = block([-10.0, -10.0, -8.0], [10.0, 10.0, 0.0], 1.0);
    let tolerance = stock.step();
    let layer = stock.found_layer(tolerance);
    let needed = stock.missed_ball_radius() + tolerance + 0.5 * stock.step();
    let of = |tool: &dyn touchoff::Tool| stock.found_layer_of(tool, tolerance);
    assert!((of(&Mill).expect("a wide tool") - layer).abs() < 1e-6);
    let necked = of(&Necked).expect("a wide tool with a neck");
    let expected = 15.0 + 2.0 * needed + 2.0 * stock.missed_ball_radius();
    assert!((expected..expected + 0.25 * needed).contains(&necked), "{necked}, not {expected}");
    assert_eq!(of(&Pin), None);
    touchoff::tool! {
        tool Drawn "a shank of 1 mm, without a holder" {
            units mm;
            profile {
                start (0, 0);
                line to (6, 0), (6, 5) as disc cutting;
                line to (0.5, 5), (0.5, 20), (0, 20) as shank;
            }
        }
    }
    let drawn = of(&Drawn).expect("a wide tool with a thin end");
    let expected = 15.0 + needed + stock.missed_ball_radius();
    assert!((expected..expected + 0.25 * needed).contains(&drawn), "{drawn}, not {expected}");
}
