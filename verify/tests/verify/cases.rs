//! Programs whose findings follow from their geometry.

use crate::block;
use crate::oracle::Mounted;
use nalgebra::Vector3;
use touchoff::certify::TriangleBvh;
use touchoff::mesh::shapes;
use touchoff::{Interval, Mesh, SurfaceId, Tool, Unit};
use touchoff_verify::{ClData, FindingKind, Verifier, VerifyReport};

touchoff::tool! {
    tool BallByRegions "a ball without a profile" {
        units mm;
        region ball as ball cutting where hypot(d, z - 3) <= 3 { depth: 3 - hypot(d, z - 3); }
        niceness cutting: 1;
    }
}

touchoff::tool! {
    tool BallByProfile "the same by its profile" {
        units mm;
        profile { start (0, 0); arc to (0, 6) center (0, 3) as ball cutting; }
        niceness cutting: 1;
    }
}

touchoff::tool! {
    solid Brick "a ball without an axis" {
        units mm;
        curve ball = hypot(x, y, z) - 1;
        region all as ball where ball <= 0 { depth: -ball; }
    }
}

/// Checks a program with a tolerance and allowances.
fn check(mesh: &Mesh, text: &str, tolerance: f64, allowances: &[(&str, f64)]) -> VerifyReport {
    let bvh = TriangleBvh::new(mesh);
    let program = ClData::parse(text, "part.cl").expect("a program");
    let verifier = Verifier::new(&bvh, &Mounted).expect("a profile");
    let verifier = verifier.with_tolerance(tolerance).expect("a length");
    let verifier = allowances.iter().fold(verifier, |verifier, (name, allowance)| {
        verifier.with_allowance(name, *allowance).expect("a surface")
    });
    verifier.check(&program).expect("it can be checked")
}

/// Returns the line, the kind and the surface of each finding.
fn summary(report: &VerifyReport) -> Vec<(usize, &'static str, Option<usize>)> {
    let keyword = |kind: &FindingKind| match kind {
        FindingKind::Deep { .. } => "deep",
        FindingKind::Near { .. } => "near",
        FindingKind::Inside { .. } => "inside",
        FindingKind::Undecided { .. } => "undecided",
        FindingKind::Ambiguous(_) => "ambiguous",
    };
    let entries =
        report.findings.iter().map(|f| (f.line, keyword(&f.kind), f.kind.surface().map(|id| id.0)));
    entries.collect()
}

/// Returns a block of 10 by 10 by 50 mm whose top is at z = 0.
fn pillar() -> Mesh {
    block([-5.0, -5.0, -50.0], [5.0, 5.0, 0.0])
}

#[test]
fn finds_a_gouge_between_two_locations_at_its_deepest() {
    let text = "MULTAX/ON\nGOTO/-30,0,-0.5,0,0,1\nGOTO/30,0,-0.5,0,0,1\nFINI\n";
    let report = check(&pillar(), text, 0.01, &[]);
    let [found] = &report.findings[..] else { panic!("{report:?}") };
    assert_eq!((found.from, found.line, found.location, found.rapid), (Some(2), 3, 1, false));
    // The ball is 0.5 deep wherever its lowest point is over the pillar.
    assert!((25.0 / 60.0..=35.0 / 60.0).contains(&found.time), "{found:?}");
    let FindingKind::Deep {
        surface: SurfaceId(0),
        allowed,
        depth: Interval { low, high },
        max_depth,
        through: false,
        ..
    } = found.kind
    else {
        panic!("{found:?}")
    };
    assert!(
        allowed == 0.01 && low <= 0.5 && 0.5 <= high && high <= max_depth && max_depth < 0.57,
        "{found:?}"
    );
    assert_eq!(check(&pillar(), text, 0.5, &[]).findings, []);
    assert_eq!(check(&pillar(), text, 0.0, &[("ball", 0.5)]).findings, []);
    assert_eq!(summary(&check(&pillar(), text, 0.5, &[("ball", 0.4)])), [(3, "deep", Some(0))]);
}

/// A wall at x = 0, and a tip 5 mm from it: the nut, of radius 8 from z = 25 on, has to turn away about the tip.
#[test]
fn a_tilt_clears_a_nut() {
    let wall = TriangleBvh::new(&block([-50.0, -60.0, -60.0], [0.0, 60.0, 60.0]));
    let program = ClData::parse("5,-1,0,0,0,1\n5,1,0,0,0,1\n", "wall.csv").expect("a program");
    let verifier = Verifier::new(&wall, &Mounted).expect("a profile");
    let report = verifier.check(&program).expect("it can be checked");
    let nut = Mounted.info().surface_named("nut");
    let found = report.findings.iter().find(|found| found.kind.surface() == nut);
    let tilt = verifier.tilt(found.expect("a finding of the nut")).expect("a tilt");
    // Its lowest circle touches the wall where 25 sin a - 8 cos a = -5.
    let least = (8.0f64 / 25.0).atan() - (5.0 / 8f64.hypot(25.0)).asin();
    let expected = Vector3::new(least.sin(), 0.0, least.cos());
    // A resolution of 0.001 is some 4e-5 rad at the nut.
    assert!((tilt.angle - least).abs() < 2e-4, "{tilt:?}, {least}");
    assert!((tilt.axis - expected).norm() < 2e-4, "{tilt:?}, {expected}");
    // A tip in the wall is not mended by a tilt.
    let program = ClData::parse("-1,-1,0,0,0,1\n-1,1,0,0,0,1\n", "in.csv").expect("a program");
    let report = verifier.check(&program).expect("it can be checked");
    assert!(!report.findings.is_empty());
    assert!(report.findings.iter().all(|found| verifier.tilt(found).is_none()));
}

#[test]
fn findings_of_cutting_surfaces_do_not_hide_others() {
    // The tool is beside the pillar and 0.2 in it; the nut reaches over the top.
    let text = "GOTO/-20,0,-26,0,0,1\nGOTO/-7.8,0,-26,0,0,1\nFINI\n";
    let expected =
        [(2, "deep", Some(0)), (2, "deep", Some(1)), (2, "deep", Some(2)), (2, "deep", Some(3))];
    assert_eq!(summary(&check(&pillar(), text, 0.0, &[])), expected);
    let unlimited = [("flute", f64::INFINITY), ("ball", f64::INFINITY)];
    assert_eq!(summary(&check(&pillar(), text, 0.0, &unlimited)), expected[2..]);
    // Over the top, the corner of shank and nut is nearest to the points under the axis.
    let with_shank = [unlimited[0], unlimited[1], ("shank", 2.0)];
    assert_eq!(summary(&check(&pillar(), text, 0.0, &with_shank)), expected[3..]);
    // Here the nut is above the top: a distance of 0.5 violates a margin of 1, and 2 does not.
    let raised = |z: f64| format!("GOTO/-20,0,{z},0,0,1\nGOTO/-7.8,0,{z},0,0,1\nFINI\n");
    let with_margin = [with_shank[0], with_shank[1], with_shank[2], ("nut", -1.0)];
    let near = check(&pillar(), &raised(-24.5), 0.0, &with_margin);
    assert_eq!(summary(&near), [(2, "near", Some(3))]);
    let FindingKind::Near { distance: Interval { low, high }, min_distance, margin: gap, .. } =
        near.findings[0].kind
    else {
        panic!("{near:?}")
    };
    assert!(
        gap == 1.0 && low <= 0.5 && 0.5 <= high && min_distance > 0.4 && min_distance <= low,
        "{near:?}"
    );
    assert_eq!(check(&pillar(), &raised(-23.0), 0.0, &with_margin).findings, []);
}

#[test]
fn reports_a_tool_axis_that_passes_through_the_part() {
    // The axis of the upright tool passes through the pillar from side to side, 6 below its top.
    let text = "GOTO/-30,0,-6,0,0,1\nGOTO/30,0,-6,0,0,1\nFINI\n";
    let report = check(&pillar(), text, 0.01, &[]);
    let through: Vec<(Option<usize>, bool)> = report
        .findings
        .iter()
        .map(|found| {
            (
                found.kind.surface().map(|id| id.0),
                matches!(found.kind, FindingKind::Deep { through: true, .. }),
            )
        })
        .collect();
    assert_eq!(through, [(Some(0), true), (Some(1), true)]);
}

#[test]
fn no_surface_may_cut_in_rapid_traverse() {
    let unlimited = [("flute", f64::INFINITY), ("ball", f64::INFINITY)];
    let feed = "GOTO/-30,0,-9,0,0,1\nGOTO/30,0,-9,0,0,1\nFINI\n";
    assert_eq!(check(&pillar(), feed, 0.01, &unlimited).findings, []);
    let rapid = "GOTO/-30,0,-9,0,0,1\nRAPID\nGOTO/30,0,-9,0,0,1\nFINI\n";
    let report = check(&pillar(), rapid, 0.01, &unlimited);
    assert_eq!(summary(&report), [(3, "deep", Some(0)), (3, "deep", Some(1))]);
    assert!(report.findings.iter().all(|found| found.rapid));
}

#[test]
fn checks_the_first_location_by_itself() {
    let report = check(&pillar(), "0,0,-0.5,0,0,1\n", 0.0, &[]);
    let [found] = &report.findings[..] else { panic!("{report:?}") };
    assert_eq!((report.motions, found.from, found.location, found.line), (0, None, 0, 1));
    assert_eq!(check(&pillar(), "0,0,0.5,0,0,1\n", 0.0, &[]).findings, []);
}

#[test]
fn finds_a_tool_inside_a_closed_part() {
    let large = block([-200.0; 3], [200.0; 3]);
    let text = "0,0,0,0,0,1\n9,0,0,0,0,1\n";
    let report = check(&large, text, 0.1, &[]);
    assert_eq!(summary(&report), [(1, "inside", None), (2, "inside", None)]);
    let unlimited = [("ball", f64::INFINITY), ("flute", f64::INFINITY)];
    assert_eq!(
        summary(&check(&large, text, 0.1, &unlimited)),
        [(1, "inside", None), (2, "inside", None)]
    );
    // All surfaces but the shank may be at any depth, and the nut ends in the open.
    let deep = block([-200.0, -200.0, -200.0], [200.0, 200.0, 38.0]);
    let limits = [unlimited[0], unlimited[1], ("nut", f64::INFINITY)];
    let shank = summary(&check(&deep, text, 0.1, &limits));
    assert_eq!(shank, [(1, "inside", Some(2)), (2, "inside", Some(2))]);
    let sheet = shapes::plane(20.0, 4, Unit::Millimetre).expect("a sheet");
    let below = check(&sheet, "0,0,-90,0,0,1\n", 0.0, &[]);
    assert!(below.findings.is_empty() && !below.inside_known);
}

#[test]
fn finds_motions_between_opposite_axes() {
    let text = "0,0,20,0,0,1\n0,0,60,0,0,-1\n0,0,2,0,0,1\n";
    let report = check(&pillar(), text, 0.0, &[]);
    // The inverted tool reaches from 60 down to 20.
    assert_eq!(summary(&report), [(2, "ambiguous", None), (3, "ambiguous", None)]);
    let into = check(&pillar(), "0,0,20,0,0,1\n0,0,30,0,0,-1\n", 0.0, &[]);
    // Over the pillar the corner between shank and nut is nearest, so both are equally deep.
    let both = [(2, "ambiguous", None), (2, "deep", Some(2)), (2, "deep", Some(3))];
    assert_eq!(summary(&into), both);
}

#[test]
fn reports_undecided_motions() {
    let bvh = TriangleBvh::new(&pillar());
    let program =
        ClData::parse("-30,0,1e-7,0,0,1\n30,0,1e-7,0.01,0,1\n", "a.csv").expect("two stops");
    let verifier = Verifier::new(&bvh, &Mounted).expect("a profile").with_budget(1);
    let report = verifier.check(&program).expect("it can be checked");
    let undecided =
        report.findings.iter().filter(|f| matches!(f.kind, FindingKind::Undecided { .. }));
    assert!(undecided.count() > 0, "{report:?}");
}

#[test]
fn rejects_unsupported_tools_and_arguments() {
    let bvh = TriangleBvh::new(&pillar());
    let spinless = ClData::parse("-30,0,9,0,0,1\n30,0,9,0,0,1\n", "a.csv").expect("two stops");
    let error = Verifier::new(&bvh, &Brick).expect("proved").check(&spinless).err();
    assert!(error.is_some_and(|error| error.code() == "P0606"));
    let margin =
        Verifier::new(&bvh, &BallByRegions).expect("proved").with_allowance("ball", -0.1).err();
    assert!(margin.is_some_and(|error| error.code() == "J0502"));
    let verifier = || Verifier::new(&bvh, &Mounted).expect("a profile");
    let message = verifier().with_allowance("fluet", 0.1).expect_err("no such surface").to_string();
    assert!(message.contains("no surface `fluet`; it has `ball`, `flute`"), "{message}");
    // All wrong allowances are told.
    let several = [("fluet", 0.1), ("ball", 0.1), ("shnak", 0.1), ("flute", f64::NAN)];
    let message = verifier().with_allowances(several).expect_err("three mistakes").to_string();
    let told = ["`fluet`", "`shnak`", "an allowance of NaN for `flute`"];
    assert!(
        told.iter().all(|word| message.contains(word)) && message.lines().count() == 3,
        "{message}"
    );
    // A stranger's job may have any number of them, and names of any text.
    let names: Vec<String> = (0..200_000).map(|number| format!("line\nbreak{number}")).collect();
    let many = names.iter().map(|name| (&**name, 0.1));
    let message = verifier().with_allowances(many).expect_err("as many mistakes").to_string();
    assert!(message.len() < 5_000 && message.lines().count() == 21, "{message}");
    assert!(message.ends_with("199980 more allowances are invalid"), "{message}");
    for invalid in [f64::NAN, f64::NEG_INFINITY] {
        assert!(verifier().with_allowance("flute", invalid).is_err());
    }
    for invalid in [f64::NAN, -1.0, f64::INFINITY] {
        assert!(
            verifier().with_tolerance(invalid).is_err()
                && verifier().with_resolution(invalid).is_err()
        );
    }
    let inch = ClData::parse("UNITS/INCHES\nGOTO/1,2,3\nFINI\n", "inch.cl").expect("a program");
    let error = verifier().check(&inch).expect_err("another unit");
    assert_eq!(error.code(), "P0605", "{error}");
}

/// Both ends of the motion are less than the diameter from the pillar, and its middle is 1 mm above it.
#[test]
fn the_nearest_approach_is_that_of_ends_and_findings() {
    let text = "-12,0,1,0,0,1\n12,0,1,0,0,1\n";
    let at_ends = check(&pillar(), text, 0.0, &[]).approach;
    assert!((5.0..5.1).contains(&at_ends.distance) && !at_ends.is_far(), "{at_ends:?}");
    let near = check(&pillar(), text, 0.0, &[("ball", -2.0)]).approach;
    assert!((1.0..1.01).contains(&near.distance), "{near:?}");
    // The depth of a point outside a tool without a profile bounds its distance only from below.
    let bvh = TriangleBvh::new(&pillar());
    let distance = |text: &str| {
        let program = ClData::parse(text, "a.csv").expect("a program");
        let verifier = Verifier::new(&bvh, &BallByRegions).expect("proved");
        verifier.check(&program).expect("it can be checked").approach.distance
    };
    assert_eq!([text, "-12,0,-1,0,0,1\n12,0,-1,0,0,1\n"].map(distance), [f64::INFINITY, 0.0]);
}

#[test]
fn findings_are_ordered_and_reproducible() {
    let rows: String = (0..150)
        .map(|k| format!("{},0,{},0,0,1\n", k % 7, 0.1 - 0.002 * f64::from(k % 97)))
        .collect();
    let report = check(&pillar(), &rows, 0.0, &[]);
    assert!(report.findings.len() > 40 && report.findings.is_sorted_by_key(|found| found.location));
    assert_eq!(check(&pillar(), &rows, 0.0, &[]), report);
}

/// A tool defined by regions is checked like one defined by a profile: the findings and their depths agree.
#[test]
fn tools_by_regions_and_by_profile_give_the_same_findings() {
    let bvh = TriangleBvh::new(&pillar());
    let text =
        "-30,0,-0.5,0,0,1\n30,0,-0.5,0,0,1\n30,0,8,0,0.6,0.8\n0,0,-0.25,0,0,1\n0,0,-20,0,0,1\n";
    let program = ClData::parse(text, "a.csv").expect("a program");
    let check = |verifier: Verifier<'_>| {
        let verifier = verifier.with_tolerance(0.01).expect("a length");
        verifier.check(&program).expect("it can be checked")
    };
    let [by_regions, by_profile] = [
        check(Verifier::new(&bvh, &BallByRegions).expect("proved")),
        check(Verifier::new(&bvh, &BallByProfile).expect("a profile")),
    ];
    assert_eq!(summary(&by_regions), summary(&by_profile));
    assert!(by_regions.findings.len() > 2, "{by_regions:?}");
    for (first, second) in by_regions.findings.iter().zip(&by_profile.findings) {
        let depth = |kind: &FindingKind| match kind {
            FindingKind::Deep { depth, .. } => Some(*depth),
            _ => None,
        };
        if let (Some(Interval { low, high }), Some(Interval { low: other_low, high: other_high })) =
            (depth(&first.kind), depth(&second.kind))
        {
            assert!(low <= other_high && other_low <= high, "{first:?}, {second:?}");
        }
    }
}
