//! Tools that are known by their depth and by how fast that changes.

use nalgebra::{Point3, Vector3};
use tool_dsl::source::Source;
use touchoff::certify::{AllowanceError, Along, Certifier, Clear, Facets, Sweep};
use touchoff::mesh::shapes;
use touchoff::tool::Interpreted;
use touchoff::{Mesh, Motion, Pose, Unit};
use touchoff_tests::oracle::draw::Draw;
use touchoff_tests::oracle::{Block, Cylinder, Fig73, LBracket, Oracle, UnitSphere};

/// Every tool of the library that has no profile, and what is true of it.
fn all() -> Vec<(&'static str, Box<dyn Oracle>)> {
    vec![
        ("Fig73", Box::new(Fig73::default())),
        ("Cylinder", Box::new(Cylinder)),
        ("UnitSphere", Box::new(UnitSphere)),
        ("Block", Box::new(Block)),
        ("LBracket", Box::new(LBracket)),
    ]
}

/// A pose about a sphere of that radius, turned anyhow.
fn about(radius: f64, draw: &mut Draw) -> Pose {
    let mut turn = [0; 4].map(|_| draw.between(-1.0, 1.0));
    let size = turn.iter().map(|part| part * part).sum::<f64>().sqrt();
    turn.iter_mut().for_each(|part| *part /= size);
    let out = Vector3::from(draw.direction()) * radius * draw.between(0.7, 1.3);
    Pose::from_quaternion(Point3::from(out), turn).expect("a quaternion")
}

fn seen(pose: &Pose, length: f64, point: Point3<f64>) -> [f64; 3] {
    (pose.rotation().transpose() * (point - pose.tip()) / length).into()
}

/// Some places of each triangle.
fn places(mesh: &Mesh, draw: &mut Draw) -> Vec<Point3<f64>> {
    let ids = (0..mesh.triangles().len() as u32).flat_map(|id| [id; 8]);
    let place = |id: u32| {
        let [a, b, c] = mesh.triangle(id);
        let (v, w) = (draw.between(0.0, 1.0), draw.between(0.0, 1.0));
        let (v, w) = if v + w > 1.0 { (1.0 - v, 1.0 - w) } else { (v, w) };
        a + v * (b - a) + w * (c - a)
    };
    ids.map(place).collect()
}

/// The deepest of some places of each triangle.
fn sampled(mesh: &Mesh, oracle: &dyn Oracle, pose: &Pose, length: f64, draw: &mut Draw) -> f64 {
    let sensed = places(mesh, draw).into_iter().filter_map(|p| oracle.sense(seen(pose, length, p)));
    sensed.map(|sense| sense.depth * length).fold(0.0, f64::max)
}

#[test]
fn what_a_field_says_is_within_the_interval() {
    const TOLERANCE: f64 = 2e-2;
    let mut draw = Draw::new(5);
    for (name, oracle) in all() {
        let tool = super::tool(name);
        let length = tool.card().unit.to(Unit::Millimetre);
        let size = length * tool.card().radius().max(tool.card().reach()[1]);
        let mesh = shapes::sphere(0.5 * size, 3, Unit::Millimetre).expect("a sphere");
        let facets = Facets::new(&mesh);
        let mut certifier = Certifier::new(&facets, tool).expect("a tool that is proved");
        let (mut touching, mut decided) = (0, 0);
        for _ in 0..12 {
            let pose = about(0.5 * size, &mut draw);
            let found = certifier.deepest(&pose, TOLERANCE * size);
            let [low, high] = found.depth;
            let brute = sampled(&mesh, &*oracle, &pose, length, &mut draw);
            assert!(brute <= high + 1e-9, "{name} {pose:?}: {brute} in {:?}", found.depth);
            if let Some(witness) = found.witness {
                touching += 1;
                let depth = oracle.sense(seen(&pose, length, witness.point)).expect("inside").depth;
                assert!(low <= depth * length + 1e-9, "{name} {pose:?}: {depth} in {low}..{high}");
            }
            decided += usize::from(high - low <= 1.01 * TOLERANCE * size);
            let clear = certifier.clear(&pose);
            match clear {
                Clear::Touching(_) => assert!(high > 0.0, "{name} {pose:?}"),
                Clear::Undecided(most) => assert!(brute <= most + 1e-9, "{name} {pose:?}"),
                _ => assert!(brute == 0.0, "{name} {pose:?}: {clear:?} at {brute}"),
            }
            let [near, far] = certifier.clearance(&pose, TOLERANCE * size).distance;
            assert!(near <= far && (brute == 0.0 || near == 0.0), "{name} {pose:?}: {near}..{far}");
        }
        assert!(touching > 3 && decided > 8, "{name}: {touching} and {decided} of 12");
    }
}

#[test]
fn a_tool_by_its_field_is_swept() {
    let plate = super::plate();
    let facets = Facets::new(&plate);
    let mut certifier = Certifier::new(&facets, super::tool("Fig73")).expect("proved");
    let at = |x: f64, z: f64| super::pose([x, 0.0, z], [0.0, 0.0, 1.0]);
    let motion = |from: [f64; 2], to: [f64; 2]| {
        Motion::new(&at(from[0], from[1]), &at(to[0], to[1])).expect("upright")
    };
    assert_eq!(certifier.sweep_clear(&motion([-8.0, 0.2], [8.0, 0.3]), 1e-3), Sweep::Clear);
    let dive = certifier.sweep_clear(&motion([-8.0, 1.0], [8.0, -1.0]), 1e-3);
    assert!(matches!(dive, Sweep::Touching(at, _) if at >= 0.5), "{dive:?}");
    let refused = certifier.allow("nose", -0.1).err();
    assert!(matches!(refused, Some(AllowanceError::NoMargin { .. })), "{refused:?}");
}

/// What a surface of the tool owns are its regions: no sample of one is deeper than it was said to be, and a witness
/// is as deep.
#[test]
fn no_sample_of_a_surface_of_a_field_is_deeper_than_it_was_said_to_be() {
    const TOLERANCE: f64 = 1e-6;
    let mut draw = Draw::new(11);
    for (name, oracle) in all() {
        let tool = super::tool(name);
        let card = tool.card();
        let length = card.unit.to(Unit::Millimetre);
        let size = length * card.radius().max(card.reach()[1]);
        let mesh = shapes::sphere(0.5 * size, 3, Unit::Millimetre).expect("a sphere");
        let facets = Facets::new(&mesh);
        let mut certifier = Certifier::new(&facets, tool).expect("a tool that is proved");
        let (mut touching, mut wide) = (0, 0);
        for _ in 0..12 {
            let pose = about(0.5 * size, &mut draw);
            let whole = certifier.deepest(&pose, TOLERANCE).depth;
            let mut most = [0.0f64; 2];
            for surface in 0..card.surfaces.len() {
                let found = certifier.deepest_on(surface, &pose, TOLERANCE);
                let text = format!("{name} {surface} at {pose:?}: {found:?}");
                let [low, high] = found.depth;
                most = [most[0].max(low), most[1].max(high)];
                wide += usize::from(high - low > 1.01 * TOLERANCE);
                let owned = |p: Point3<f64>| {
                    let sense = oracle.sense(seen(&pose, length, p))?;
                    Some((sense.depth * length, card.regions[sense.owner].surface))
                };
                for point in places(&mesh, &mut draw) {
                    if let Some((depth, owner)) = owned(point)
                        && owner == surface
                    {
                        assert!(depth <= high + 1e-9, "{text}: {depth} at {point}");
                    }
                }
                if let Some(witness) = found.witness {
                    touching += 1;
                    assert_eq!(witness.surface, surface, "{text}");
                    let (depth, _) = owned(witness.point).expect("inside");
                    assert!(low <= depth + 1e-9, "{text}: {depth}");
                }
            }
            let agree = most[0] <= whole[1] + 1e-9 && whole[0] <= most[1] + 1e-9;
            assert!(agree, "{name} at {pose:?}: {most:?} of each, {whole:?} of all");
        }
        assert!(touching > 5 && wide == 0, "{name}: {touching} touch, {wide} are wide");
    }
}

/// A cylinder beside a wall: its side may cut, its ends may not.
#[test]
fn surfaces_of_a_field_are_allowed_for_one_by_one() {
    let (low, high) = (Point3::new(1.5, -30.0, 1.0), Point3::new(40.0, 30.0, 5.0));
    let wall = Facets::new(&shapes::cuboid(low, high, Unit::Millimetre).expect("a cuboid"));
    let at = |y: f64, z: f64| super::pose([0.0, y, z], [0.0, 0.0, 1.0]);
    // 0.5 mm deep, and 1 mm from the ends: on the edges of the wall the nearest end is as near as 0.5.
    let certifier = || Certifier::new(&wall, super::tool("Cylinder")).expect("proved");
    let mut side = certifier().allow("side", f64::INFINITY).expect("a surface");
    assert_eq!(side.clear(&at(0.0, 0.0)), Clear::Clear);
    let along = Motion::new(&at(-1.0, 0.0), &at(1.0, 0.0)).expect("upright");
    assert_eq!(side.sweep_clear(&along, 1e-6), Sweep::Clear);
    let found = certifier().deepest_along(0, &along, 0.4, 1e-6);
    let Along::Deeper { depth: [low, high], most, .. } = found else { panic!("{found:?}") };
    assert!(low <= 0.5 && 0.5 <= high + 1e-9 && most < 0.52, "{found:?}");
    assert_eq!(certifier().deepest_along(1, &along, 0.0, 1e-6), Along::Within);
    // Higher by 0.8, the wall's lower edge is nearer to the bottom.
    let Clear::Touching(witness) = side.clear(&at(0.0, 0.8)) else { panic!("it touches") };
    assert_eq!(witness.surface, 1);
    let up = Motion::new(&at(0.0, 0.0), &at(0.0, 0.8)).expect("upright");
    assert!(matches!(side.sweep_clear(&up, 1e-6), Sweep::Touching(at, _) if at > 0.6));
}

#[test]
fn every_tool_of_the_library_is_certified() {
    let facets = Facets::new(&super::plate());
    for tool in tools_library::TOOLS {
        assert!(Certifier::new(&facets, *tool).is_ok(), "{}", tool.card().name);
    }
}

#[test]
fn a_tool_whose_depth_jumps_is_refused() {
    let text = "tool Jump { units mm;
        region low as body cutting where d <= 2, 0 <= z, z <= 1 { depth: min(z, 2 - d); }
        region high as body cutting where d <= 2, 1 <= z, z <= 3 { depth: min(3 - z, 2 - d); }
        niceness cutting: 1; }";
    let tool = Interpreted::parse(&Source::new("jump.tool", text)).expect("a tool");
    let facets = Facets::new(&super::plate());
    let refused = Certifier::new(&facets, &tool).err().expect("a refusal").to_string();
    assert!(refused.contains("Jump") && refused.contains("profile"), "{refused}");
}
