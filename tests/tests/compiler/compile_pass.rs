//! Tools in a program: written in place and from a file, with all features of the language.

use touchoff::Unit;
use touchoff::tool::{Evaluators, Tool};

touchoff::include_tool!("../tools-library/tools/d2_ball.tool");

touchoff::tool! {
    /// A comment of Rust's in front of the tool means nothing.
    tool Bull "torus end mill, 12 mm, corner 2 mm" {
        //! And so does one inside.
        units inch;
        param D = 12mm;                       // a number may carry its own unit
        param r = 2mm;
        let   R = D/2 - r*tan(45deg);         /* out to the corner's centre */
        tip   z = -1;

        curve ring  = hypot(d - R, z + 1 - r) - r;
        curve wall  = d - D/2;
        curve floor = -1 - z;
        curve end   = z - 1;

        bsp { ring, end, }

        region corner as edge cutting where d >= R, z <= r - 1, ring <= 0 {
            depth:     -ring;
            direction: away from (R, r - 1);
        }
        region bottom as edge cutting where d <= R, 0 >= floor, -floor <= min(-wall, -end) {
            depth: -floor;
        }
        region side as shank where z >= r - 1, 0 >= wall >= max(floor, end) {
            depth: -wall;
        }
        region above as shank where 0 >= end >= max(floor, wall), max(R - d, z + 1 - r) >= 0 {
            depth: -end;
        }
        magnitude edge: 3*depth^1.5;
        magnitude: 2*depth;
        niceness cutting: 1 - depth;
    }
}

/// Tools with names of types that their code uses, one with a profile and one by hand.
mod names {
    touchoff::tool! {
        tool Circle {
            units mm;
            profile { start (0, 0); arc to (0, 6) center (0, 3) as ball cutting; }
        }
    }
    touchoff::tool! {
        tool Lane {
            units mm;
            region rod where d <= 3, 0 <= z <= 20 { depth: min(3 - d, z, 20 - z); }
        }
    }
}

#[test]
fn a_tool_may_have_the_name_of_a_type_that_its_code_uses() {
    assert!(names::Circle::contains([0.0, 0.0, 1.0]) && names::Lane::contains([0.0, 0.0, 1.0]));
}

#[test]
fn a_tool_from_a_file_equals_the_library_tool() {
    assert_eq!(D2Ball.info(), touchoff_tools::D2Ball.info());
    let p = [0.3, -0.4, 2.0];
    let own = D2Ball::evaluate_point(p, 1.0).expect("a point inside");
    assert_eq!(own.region, 1);
    assert_eq!(Some(own), touchoff_tools::D2Ball::evaluate_point(p, 1.0));
}

#[test]
fn an_inline_tool_has_the_written_values() {
    let info = Bull.info();
    assert_eq!((info.name.as_ref(), info.unit), ("Bull", Unit::Inch));
    assert_eq!(info.title, "torus end mill, 12 mm, corner 2 mm");
    let regions: Vec<&str> = info.regions.iter().map(|region| region.name.as_ref()).collect();
    assert_eq!(regions, ["corner", "bottom", "side", "above"]);
    let surfaces: Vec<(&str, bool)> =
        info.surfaces.iter().map(|surface| (surface.name.as_ref(), surface.cutting)).collect();
    assert_eq!(surfaces, [("edge", true), ("shank", false)]);
    assert!((info.radius() - 6.0 / 25.4).abs() < 1e-4);
    assert!((info.reach().high - 2.0).abs() < 1e-4);
}

#[test]
fn laws_and_units_do_not_mix() {
    // Above the middle of the floor, 0.02 inch deep, and the part in mm: a magnitude that the file writes stays the
    // file's number, and its gradient is per millimetre of the part.
    let evaluation = Bull::evaluate_point([0.01, 0.0, 0.02], 25.4).expect("inside");
    assert_eq!(evaluation.region, 1);
    let is_close = |a: f64, b: f64| (a - b).abs() < 1e-14;
    assert!(is_close(evaluation.depth, 0.02));
    assert!(is_close(evaluation.magnitude, 3.0 * 0.02f64.powf(1.5)));
    assert!(is_close(evaluation.niceness, 0.98));
    assert!(is_close(evaluation.direction[2], -1.0));
    assert!(is_close(evaluation.gradient[2], 4.5 * 0.02f64.sqrt() / 25.4));
    // The shank has the law for all, and does not cut.
    let evaluation = Bull::evaluate_point([0.0, 0.23, 1.0], 25.4).expect("inside");
    assert_eq!(evaluation.region, 2);
    let depth = 6.0 / 25.4 - 0.23;
    assert!(is_close(evaluation.magnitude, 2.0 * depth));
    assert_eq!(evaluation.niceness, 0.0);
    assert!(Bull::evaluate_point([0.24, 0.0, 1.0], 25.4).is_none());
}
