//! Verdicts on motions, checked against known geometry and against samples of motions.

mod sampled;

use crate::prelude::*;
use touchoff::MotionError;

fn sweep(mesh: &Mesh, name: &str, path: &Motion, tolerance: f64) -> MotionVerdict {
    certifier(mesh, name).check_motion(path, tolerance)
}

/// Returns an axis that leans from z toward x.
fn leaning(degrees: f64) -> [f64; 3] {
    let (sin, cos) = degrees.to_radians().sin_cos();
    [sin, 0.0, cos]
}

#[test]
fn a_ball_slides_along_a_plate_at_any_height() {
    let slide = |height: f64| {
        motion(&pose([-12.0, 0.3, height], UP), &pose([11.0, -0.2, height], leaning(40.0)))
    };
    // The axis rotates about the tip, so the ball's lowest point sinks below the tip by 1 - cos.
    let sinks = 1.0 - 40f64.to_radians().cos();
    let level = |height| motion(&pose([-12.0, 0.3, height], UP), &pose([11.0, -0.2, height], UP));
    for height in [0.5, 1e-3, 1e-6, 1e-9] {
        for tolerance in [0.0, 1e-6, 1e-3, f64::NAN] {
            assert_eq!(sweep(&plate(), "D2Ball", &level(height), tolerance), MotionVerdict::Clear);
            let swept = sweep(&plate(), "D2Ball", &slide(sinks + height), tolerance);
            assert_eq!(swept, MotionVerdict::Clear);
        }
    }
    for depth in [0.5, 1e-3, 1e-6, 1e-9] {
        let (at, witness) = touching(sweep(&plate(), "D2Ball", &level(-depth), 0.0));
        assert!((0.0..=1.0).contains(&at) && witness.point.z.abs() < 1e-12, "{at} {witness:?}");
        let (at, _) = touching(sweep(&plate(), "D2Ball", &slide(sinks - depth), 0.0));
        let lean = (1.0 - (sinks - depth).max(0.0)).acos().to_degrees();
        assert!(at >= lean / 40.0 - 1e-6, "{depth:e}: {at}");
    }
    // Flush contact is no deeper than rounding.
    assert_eq!(sweep(&plate(), "D2Ball", &level(0.0), 1e-6), MotionVerdict::Clear);
    assert_eq!(sweep(&plate(), "D2Ball", &level(0.0), 0.0), MotionVerdict::Clear);
    assert_eq!(sweep(&plate(), "Flat", &level(0.0), 1e-6), MotionVerdict::Clear);
}

#[test]
fn contact_deeper_than_the_tolerance_is_found() {
    let path = |depth: f64| motion(&pose([-9.0, 0.0, 2.0], UP), &pose([3.0, 1.0, -depth], UP));
    for tolerance in [1e-6, 1e-3, 0.1] {
        touching(sweep(&plate(), "BullNose", &path(1.001 * tolerance), tolerance));
        assert_eq!(sweep(&plate(), "BullNose", &path(-1e-9), tolerance), MotionVerdict::Clear);
    }
}

#[test]
fn a_plunge_touches_at_the_end_of_its_descent() {
    let plunge = |to: f64| motion(&pose([0.3, 0.1, 5.0], UP), &pose([0.3, 0.1, to], UP));
    for name in ["D2Ball", "Flat", "BullNose", "TSlot", "Lollipop"] {
        let (at, witness) = touching(sweep(&plate(), name, &plunge(-1.0), 0.0));
        assert!((5.0 / 6.0..=1.0).contains(&at), "{name}: {at}");
        let point = witness.point;
        assert!(point.z.abs() < 1e-12 && point.xy().coords.norm() < 11.0, "{name}: {point}");
        for gap in [1e-3, 1e-9] {
            assert_eq!(sweep(&plate(), name, &plunge(gap), 0.0), MotionVerdict::Clear, "{name}");
            let back = motion(&plunge(gap).pose(1.0), &plunge(gap).pose(0.0));
            assert_eq!(sweep(&plate(), name, &back, 0.0), MotionVerdict::Clear, "{name}");
        }
        let (at, _) = touching(sweep(&plate(), name, &plunge(-1e-9), 0.0));
        assert!(at > 1.0 - 1e-9, "{name}: {at}");
    }
}

#[test]
fn a_long_cylinder_swings_against_a_wall() {
    // The rim of the top, 83 up and 6 out, reaches the wall first.
    let wall = block([20.0, -50.0, -200.0], [30.0, 50.0, 200.0]);
    let contact = (20.0 / 83f64.hypot(6.0)).asin() - (6f64 / 83.0).atan();
    let contact = contact.to_degrees();
    let swing = |to: f64| motion(&pose([0.0; 3], leaning(-70.0)), &pose([0.0; 3], leaning(to)));
    for short in [1.0, 1e-3, 1e-6] {
        assert_eq!(sweep(&wall, "Flat", &swing(contact - short), 0.0), MotionVerdict::Clear);
        let (at, witness) = touching(sweep(&wall, "Flat", &swing(contact + short), 0.0));
        let first = (70.0 + contact) / (70.0 + contact + short);
        assert!((first - 1e-12..=1.0).contains(&at), "{short:e}: {at}");
        assert!((witness.point.x - 20.0).abs() < 1e-12, "{witness:?}");
    }
}

#[test]
fn a_long_cylinder_swings_below_a_ceiling() {
    // Midway through the motion the rim is at the top of its circle.
    let top = 83f64.hypot(6.0);
    let swing = motion(&pose([0.0; 3], leaning(-75.0)), &pose([0.0; 3], leaning(75.0)));
    for gap in [1.0, 1e-3] {
        let ceiling = block([-300.0, -300.0, top + gap], [300.0, 300.0, 200.0]);
        assert_eq!(sweep(&ceiling, "Flat", &swing, 0.0), MotionVerdict::Clear, "{gap:e}");
        let ceiling = block([-300.0, -300.0, top - gap], [300.0, 300.0, 200.0]);
        touching(sweep(&ceiling, "Flat", &swing, 0.0));
        // The motion also passes over an edge at that height.
        let fence = soup(&[[[0.0, 0.0, top + gap], [-5.0, 100.0, 100.0], [5.0, 100.0, 100.0]]]);
        assert_eq!(sweep(&fence, "Flat", &swing, 0.0), MotionVerdict::SurfaceOnly, "{gap:e}");
    }
}

#[test]
fn a_motion_at_rest_has_the_verdict_of_its_pose() {
    let mut certifier = certifier(&plate(), "BullNose");
    for height in [0.5, 1e-9, -1e-9, -0.5, -3.0] {
        for lean in [0.0, 20.0, 170.0] {
            let pose_at_rest = pose([1.0, 2.0, height], leaning(lean));
            let path = motion(&pose_at_rest, &pose_at_rest);
            let (still, swept) =
                (certifier.check_pose(&pose_at_rest), certifier.check_motion(&path, 0.0));
            let same = matches!(
                (still, swept),
                (PoseVerdict::Clear, MotionVerdict::Clear)
                    | (PoseVerdict::Touching(_), MotionVerdict::Touching(..))
            );
            assert!(same, "{height} {lean}: {still:?} {swept:?}");
        }
    }
}

#[test]
fn opposite_axes_are_rejected() {
    let up = pose([0.0; 3], UP);
    let down = pose([1.0, 2.0, 3.0], [0.0, 0.0, -1.0]);
    assert_eq!(Motion::new(&up, &down), Err(MotionError::Opposite));
    let nearly = pose([1.0, 2.0, 3.0], leaning(180.0 - 1e-10));
    assert_eq!(Motion::new(&up, &nearly), Err(MotionError::Opposite));
    let motion_of_179_degrees = motion(&up, &pose([1.0, 2.0, 3.0], leaning(179.0)));
    assert!((motion_of_179_degrees.angle().to_degrees() - 179.0).abs() < 1e-9);
}

#[test]
fn without_a_budget_nothing_is_decided() {
    let path = motion(&pose([-9.0, 0.0, 1e-6], UP), &pose([9.0, 0.0, 1e-6], UP));
    for budget in [0, 1, 3] {
        let mut certifier = certifier(&plate(), "BullNose").with_budget(budget);
        let verdict = certifier.check_motion(&path, 0.0);
        let MotionVerdict::Undecided(at) = verdict else { panic!("{verdict:?}") };
        assert!((0.0..1.0).contains(&at), "{verdict:?}");
    }
}

#[test]
fn a_motion_may_stay_in_material_or_beside_an_open_sheet() {
    let large = block([-200.0; 3], [200.0; 3]);
    let inside = motion(&pose([-90.0, 0.0, -90.0], UP), &pose([90.0, 20.0, 0.0], leaning(100.0)));
    assert!(matches!(sweep(&large, "D2Ball", &inside, 0.0), MotionVerdict::Inside(_)));
    let out = motion(&pose([-90.0, 0.0, -90.0], UP), &pose([300.0, 20.0, 0.0], UP));
    touching(sweep(&large, "D2Ball", &out, 0.0));
    let sheet = shapes::plane(20.0, 4, Unit::Millimetre).expect("a sheet");
    let above = motion(&pose([-9.0, 0.0, 1e-3], UP), &pose([9.0, 0.0, 1e-3], UP));
    assert_eq!(sweep(&sheet, "D2Ball", &above, 0.0), MotionVerdict::SurfaceOnly);
    let through = motion(&pose([-9.0, 0.0, 50.0], UP), &pose([9.0, 0.0, -100.0], UP));
    touching(sweep(&sheet, "D2Ball", &through, 0.0));
}

#[test]
fn long_rapid_motions_are_decided() {
    let rapid = |height: f64, to: [f64; 3]| {
        motion(&pose([-1e6, 0.0, height], UP), &pose([1e6, 0.0, height], to))
    };
    for height in [30.0, 0.5, 1e-3] {
        assert_eq!(sweep(&plate(), "D2Ball", &rapid(height, UP), 0.0), MotionVerdict::Clear);
    }
    for depth in [1e-3, 0.5, 5.0] {
        let (at, _) = touching(sweep(&plate(), "D2Ball", &rapid(-depth, UP), 0.0));
        assert!((at - 0.5).abs() < 1.1e-5, "{depth}: {at}");
    }
    let turning = sweep(&plate(), "D2Ball", &rapid(30.0, leaning(150.0)), 0.0);
    assert_eq!(turning, MotionVerdict::Clear);
    let diagonal = motion(&pose([1e6, 0.0, 0.0], UP), &pose([0.0, 1e6, 0.0], leaning(150.0)));
    assert_eq!(sweep(&plate(), "HalfInchBallCat40", &diagonal, 0.0), MotionVerdict::Clear);
}
