//! Tools whose profiles overhang, once more by hand.

use touchoff::Tool;
use touchoff_tests::oracle::Nearest;
use touchoff_tests::oracle::restated::Restated;

touchoff::tool! {
    tool HoleSaw "38 mm, 12 mm deep" {
        units mm;
        profile {
            start (0, 12);
            line to (16, 12), (16, 0) as cup;
            line to (19, 0) as teeth cutting;
            line to (19, 18), (5, 18), (5, 45), (0, 45) as body;
        }
        niceness teeth: 1;
    }
}

touchoff::tool! {
    tool Dished "a dovetail whose face is dished by 0.2 mm" {
        units mm;
        profile {
            start (0, 0.2);
            line to (8, 0) as face cutting;
            line to (5, 6) as flank cutting;
            line to (4, 7), (4, 40), (0, 40) as shank;
        }
        niceness face: 1;
        niceness flank: 1;
    }
}

touchoff::tool! {
    tool Bell "hollow and round arcs on both sides" {
        units mm;
        profile {
            start (0, 8);
            arc to (6, 2) center (0, 2) concave as dome;
            arc to (8, 0) center (8, 2) as lip cutting;
            arc to (10, 2) center (8, 2) as lip cutting;
            line to (10, 12) as side cutting;
            arc to (5, 17) center (10, 17) concave as neck;
            line to (5, 40), (0, 40) as shank;
        }
        niceness lip: 1;
        niceness side: 1;
    }
}

touchoff::tool! {
    tool Skirt "a stem with a skirt about it" {
        units mm;
        profile {
            start (0, 0);
            line to (3, 0) as face cutting;
            line to (3, 10), (8, 9), (7.5, 4) as under;
            line to (10, 3.5) as lip cutting;
            line to (12, 15), (4, 18), (4, 40), (0, 40) as top;
        }
        niceness face: 1;
        niceness lip: 1;
    }
}

/// The names of those above.
pub(crate) const ALL: [&str; 4] = ["HoleSaw", "Dished", "Bell", "Skirt"];

/// One of those above.
pub(crate) fn tool(name: &str) -> Option<&'static dyn Tool> {
    let all: [&dyn Tool; 4] = [&HoleSaw, &Dished, &Bell, &Skirt];
    all.into_iter().find(|tool| tool.card().name == name)
}

/// The same from its drawing's numbers.
pub(crate) fn oracle(name: &str) -> Option<Nearest> {
    let tool = match name {
        "HoleSaw" => Restated::new("HoleSaw", 12.0)
            .lines("cup", &[[16.0, 12.0], [16.0, 0.0]])
            .line("teeth", 19.0, 0.0)
            .lines("body", &[[19.0, 18.0], [5.0, 18.0], [5.0, 45.0], [0.0, 45.0]])
            .cuts(&["teeth"], |_, _, _| 1.0),
        "Dished" => Restated::new("Dished", 0.2)
            .line("face", 8.0, 0.0)
            .line("flank", 5.0, 6.0)
            .lines("shank", &[[4.0, 7.0], [4.0, 40.0], [0.0, 40.0]])
            .cuts(&["face", "flank"], |_, _, _| 1.0),
        "Bell" => Restated::new("Bell", 8.0)
            .arc("dome", [6.0, 2.0], [0.0, 2.0])
            .arc("lip", [8.0, 0.0], [8.0, 2.0])
            .arc("lip", [10.0, 2.0], [8.0, 2.0])
            .line("side", 10.0, 12.0)
            .arc("neck", [5.0, 17.0], [10.0, 17.0])
            .lines("shank", &[[5.0, 40.0], [0.0, 40.0]])
            .cuts(&["lip", "side"], |_, _, _| 1.0),
        "Skirt" => Restated::new("Skirt", 0.0)
            .line("face", 3.0, 0.0)
            .lines("under", &[[3.0, 10.0], [8.0, 9.0], [7.5, 4.0]])
            .line("lip", 10.0, 3.5)
            .lines("top", &[[12.0, 15.0], [4.0, 18.0], [4.0, 40.0], [0.0, 40.0]])
            .cuts(&["face", "lip"], |_, _, _| 1.0),
        _ => return None,
    };
    Some(Nearest::new(&tool))
}
