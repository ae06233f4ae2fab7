//! Tools for holes and threads.

use super::super::big::Big;
use super::Restated;

pub(super) fn all() -> Vec<Restated> {
    vec![
        drill(),
        spot_drill(),
        countersink(),
        reamer(),
        boring_bar(),
        single_tooth(),
        thread_mill(),
    ]
}

/// 118° at the point: 59° from the axis.
pub(super) fn drill() -> Restated {
    Restated::new("Drill", 0.0)
        .line("point", 4.25, Big::decimal(4.25) / Big::tan_deg(59.0))
        .line("flute", 4.25, 75.0)
        .lines("shank", &[[4.25, 117.0], [0.0, 117.0]])
        .cuts(&["point"], |_, _, _| 1.0)
}

fn spot_drill() -> Restated {
    Restated::new("SpotDrill", 0.0)
        .line("point", 4.0, 4.0)
        .line("flute", 4.0, 25.0)
        .lines("shank", &[[4.0, 79.0], [0.0, 79.0]])
        .cuts(&["point"], |_, depth, _| 1.0 - depth / 4.0)
}

fn countersink() -> Restated {
    Restated::new("Countersink", 0.0)
        .line("tip", 1.6, 0.0)
        .line("cone", 8.25, 6.65)
        .line("land", 8.25, 7.5)
        .lines("shank", &[[5.0, 12.0], [5.0, 60.0], [0.0, 60.0]])
        .cuts(&["cone"], |_, depth, _| 1.0 - depth / 3.0)
}

fn reamer() -> Restated {
    Restated::new("Reamer", 0.0)
        .line("face", 3.0, 0.0)
        .line("lead", 4.0, 1.0)
        .line("land", 4.0, 33.0)
        .lines("neck", &[[3.6, 34.0], [3.6, 75.0]])
        .lines("shank", &[[4.0, 76.0], [4.0, 117.0], [0.0, 117.0]])
        .cuts(&["lead", "land"], |surface, depth, _| {
            1.0 - depth / if surface == "lead" { 0.2 } else { 0.05 }
        })
}

fn boring_bar() -> Restated {
    Restated::new("BoringBar", 0.6)
        .lines("front", &[[14.0, 0.6], [15.6, 0.0]])
        .arc("nose", [16.0, 0.4], [15.6, 0.4])
        .line("relief", 15.0, 9.0)
        .lines("bar", &[[12.5, 9.0], [12.5, 150.0], [0.0, 150.0]])
        .cuts(&["nose"], |_, depth, _| 1.0 - depth / 0.4)
}

/// Returns the rise of a flank of 30° over 0.9.
fn flank() -> Big {
    Big::decimal(0.9) / Big::decimal(3.0).sqrt()
}

fn single_tooth() -> Restated {
    Restated::new("SingleTooth", 0.0)
        .line("face", 2.05, 0.0)
        .line("tooth", 2.95, flank())
        .line("tooth", 2.95, flank() + 0.1)
        .line("tooth", 2.05, flank() * 2.0 + 0.1)
        .line("neck", 2.05, 20.0)
        .lines("shank", &[[3.0, 21.0], [3.0, 58.0], [0.0, 58.0]])
        .cuts(&["tooth"], |_, depth, _| 1.0 - depth)
}

fn thread_mill() -> Restated {
    let mut tool = Restated::new("ThreadMill", 0.0).line("face", 3.0, 0.0);
    for z in [0.0, 1.5, 3.0, 4.5, 6.0] {
        if z > 0.0 {
            tool = tool.line("groove", 3.0, z);
        }
        tool = tool.line("tooth", 3.9, flank() + z).line("tooth", 3.9, flank() + (z + 0.1875));
        tool = tool.line("tooth", 3.0, flank() * 2.0 + (z + 0.1875));
    }
    tool.line("neck", 3.0, 24.0)
        .lines("shank", &[[4.0, 25.0], [4.0, 63.0], [0.0, 63.0]])
        .cuts(&["tooth"], |_, depth, _| 1.0 - depth)
}
