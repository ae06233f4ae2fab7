//! Solids of Ho 1999, and the plain ball cutter beside them.

use super::Restated;

pub(super) fn all() -> Vec<Restated> {
    let drawn = |name, drawing| Restated::drawn(name, drawing, &[]);
    vec![
        drawn("UnitSphere", "0 0; ball 0 2 about 0 1"),
        drawn("Cylinder", "0 0; bottom 2 0; side 2 6; top 0 6"),
        // The half sphere of radius 2 joined to a cylinder of radius 1 (fig. 2.2, 2.3), 8 long.
        drawn("HalfSphereCylinder", "0 0; ball 2 2 about 0 2; step 1 2; stem 1 8, 0 8"),
        // The ball end mill of fig. 7.3, with niceness as in eq. 7.3.
        drawn(
            "Fig73Exact",
            "0 0; nose 1 1 about 0 1; flute 1 5; spindle 3 7, 3 9; housing 5 9, 5 20, 0 20",
        )
        .cuts("nose flute", |surface, _, [d, z]| match surface {
            "flute" => 2.0 * d * d,
            _ => 2.0 * d * d + (z - 1.0) * (z - 1.0),
        }),
        // A plain 2 mm ball end mill, 40 long, its flute 5.
        drawn("D2Ball", "0 0; ball 1 1 about 0 1; flute 1 5; shank 1 40, 0 40")
            .cuts("ball flute", |_, depth, _| 1.0 - depth),
    ]
}
