//! Solids of Ho 1999, and the plain ball cutter beside them.

use super::Restated;

pub(super) fn all() -> Vec<Restated> {
    vec![unit_sphere(), cylinder(), half_sphere_cylinder(), fig_7_3_exact(), d2_ball()]
}

fn unit_sphere() -> Restated {
    // Two quarters, since an arc is less than 180°.
    let half = Restated::new("UnitSphere", 0.0).arc("ball", [1.0, 1.0], [0.0, 1.0]);
    half.arc("ball", [0.0, 2.0], [0.0, 1.0])
}

fn cylinder() -> Restated {
    let low = Restated::new("Cylinder", 0.0).line("bottom", 2.0, 0.0);
    low.line("side", 2.0, 6.0).line("top", 0.0, 6.0)
}

/// The half sphere of radius 2 joined to a cylinder of radius 1 (fig. 2.2, 2.3), 8 long.
fn half_sphere_cylinder() -> Restated {
    let ball = Restated::new("HalfSphereCylinder", 0.0).arc("ball", [2.0, 2.0], [0.0, 2.0]);
    ball.line("step", 1.0, 2.0).lines("stem", &[[1.0, 8.0], [0.0, 8.0]])
}

/// The ball end mill of fig. 7.3, with niceness as in eq. 7.3.
fn fig_7_3_exact() -> Restated {
    Restated::new("Fig73Exact", 0.0)
        .arc("nose", [1.0, 1.0], [0.0, 1.0])
        .line("flute", 1.0, 5.0)
        .lines("spindle", &[[3.0, 7.0], [3.0, 9.0]])
        .lines("housing", &[[5.0, 9.0], [5.0, 20.0], [0.0, 20.0]])
        .cuts(&["nose", "flute"], |surface, _, [d, z]| match surface {
            "flute" => 2.0 * d * d,
            _ => 2.0 * d * d + (z - 1.0) * (z - 1.0),
        })
}

/// A plain 2 mm ball end mill, 40 long, its flute 5.
fn d2_ball() -> Restated {
    Restated::new("D2Ball", 0.0)
        .arc("ball", [1.0, 1.0], [0.0, 1.0])
        .line("flute", 1.0, 5.0)
        .lines("shank", &[[1.0, 40.0], [0.0, 40.0]])
        .cuts(&["ball", "flute"], |_, depth, _| 1.0 - depth)
}
