mod refused;

use super::layout::{List, lists};
use super::*;
use crate::cloud::Sampling;
use crate::cloud::{Cloud, CoveringRadius};
use crate::mesh::shapes;
use crate::point_bvh::PointBvh;
use crate::pose::Pose;
use crate::probe::Probe;
use crate::scenes::{self, ScenePath as Course};
use crate::tool::Interpreted;
use crate::unit::Unit;
use nalgebra::Point3;
use std::fs::{self, File};
use std::sync::LazyLock;

static BALL: LazyLock<Interpreted> = LazyLock::new(|| {
    r#"tool Ball "a ball on a straight shank" {
        units mm;
        let r = 1;
        curve nose = hypot(d, z - r) - r;
        curve side = r - d;
        curve end = 30 - z;
        region ball as ball cutting where z <= r, nose <= 0 { depth: -nose; }
        region shank where z >= r, 0 <= side <= end { depth: side; }
        region end as shank where 0 <= end <= side { depth: end; }
        niceness cutting: 1 - depth/r;
    }"#
    .parse()
    .expect("a tool")
});

fn open(bytes: &[u8]) -> Result<Part, SavedError> {
    read::part(bytes, bytes.len() as u64, "a.part")
}

fn says(bytes: &[u8]) -> String {
    open(bytes).expect_err("it should be refused").to_string()
}

fn saved(part: &Part) -> Vec<u8> {
    let (header, sections) = layout::of(part);
    let mut bytes = Vec::new();
    write(&mut bytes, &header, &sections).expect("written");
    bytes
}

fn cuboid() -> crate::Mesh {
    shapes::cuboid(Point3::origin(), Point3::new(9.0, 8.0, 7.0), Unit::Millimetre).expect("a mesh")
}

/// Returns a part of forty points, which fits into some thousand bytes.
fn small() -> Part {
    Part::from_mesh(&cuboid(), Sampling::new(40)).expect("a part")
}

/// Returns all lists as bytes.
fn bits(part: &Part) -> Vec<u8> {
    let mut all = Vec::new();
    for tree in &part.levels {
        tree.levels.iter().for_each(|boxes| all.extend(bytemuck::cast_slice::<_, u8>(boxes)));
        all.extend(bytemuck::cast_slice::<_, u8>(&tree.leaves));
        all.extend(bytemuck::cast_slice::<_, u8>(&tree.attributes));
        all.extend(bytemuck::cast_slice::<_, u8>(&tree.triangles));
    }
    all
}

/// Returns all query results at some poses, in a text that distinguishes all numbers.
fn evaluations(part: &Part, poses: &[Pose]) -> String {
    let mut probe = Probe::new(part, &*BALL);
    let mut evaluations =
        format!("{:?} {:?} {:?}\n", part.unit(), part.diagnostics(), part.tree().covering_radius());
    for pose in poses {
        let (any, wrench, deepest) = (probe.detect(pose), probe.wrench(pose), probe.deepest(pose));
        evaluations += &format!("{any} {wrench:?} {deepest:?} {:?}\n", probe.contacts(pose));
    }
    evaluations
}

fn along_the_courses(each: usize) -> Vec<Pose> {
    Course::ALL.iter().flat_map(|path| (0..each).map(|k| path.pose(k, each))).collect()
}

#[test]
fn an_opened_part_feels_like_the_one_that_was_saved() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("tube.part");
    let poses = along_the_courses(500);
    let tube = scenes::tube();
    let random =
        Part::from_cloud(&Cloud::sample(&tube, Sampling::monte_carlo(20_000)).expect("a cloud"));
    let even = Part::from_mesh(&tube, Sampling::new(3_000)).expect("a part");
    let few = Part::from_cloud(&Cloud::sample(&tube, Sampling::monte_carlo(16)).expect("a cloud"));
    let one = Part::from_cloud(&Cloud::sample(&tube, Sampling::monte_carlo(1)).expect("a cloud"));
    for part in [random, even, few, one] {
        part.save(&path).expect("saved");
        let opened = Part::open(&path).expect("opened");
        assert!(bits(&part) == bits(&opened));
        assert!(evaluations(&part, &poses) == evaluations(&opened, &poses));
        let (part, opened) = (part.converted_to(Unit::Inch), opened.converted_to(Unit::Inch));
        assert!(evaluations(&part, &poses[..100]) == evaluations(&opened, &poses[..100]));
        // Replace the file that the part was opened from.
        opened.save(&path).expect("saved");
        assert!(evaluations(&part, &poses[..100]) == evaluations(&opened, &poses[..100]));
        let again = Part::open(&path).expect("opened");
        assert!(evaluations(&part, &poses[..100]) == evaluations(&again, &poses[..100]));
    }
    assert_eq!(fs::read_dir(folder.path()).expect("a folder").count(), 1, "nothing is left over");
}

#[test]
fn what_is_cut_stays_cut() {
    let poses = along_the_courses(100);
    let mut part = Part::with_lods(&scenes::tube(), Sampling::new(4_000)).expect("a part");
    let mut opened = open(&saved(&part)).expect("opened");
    // An opened part can be edited in the same way, and an edited part can be saved.
    for pose in &poses {
        assert_eq!(part.cut(&*BALL, pose), opened.cut(&*BALL, pose));
    }
    assert!(part.tree().removed > 0 && bits(&part) == bits(&opened));
    let again = open(&saved(&part)).expect("opened");
    assert_eq!(again.tree().len(), part.tree().len());
    assert!(evaluations(&part, &poses) == evaluations(&opened, &poses));
    assert!(evaluations(&part, &poses) == evaluations(&again, &poses));
    let lift = |point: Point3<f64>, normal: nalgebra::Vector3<f64>| (point + 0.01 * normal, normal);
    part.displace(lift).expect("places");
    opened.displace(lift).expect("places");
    assert!(
        bits(&part) == bits(&opened) && evaluations(&part, &poses) == evaluations(&opened, &poses)
    );
}

#[test]
fn every_tree_is_saved() {
    let mut part = small();
    for (points, proved) in [(300, false), (17, true)] {
        let mut tree = PointBvh::new(
            &Cloud::sample(&cuboid(), Sampling::monte_carlo(points)).expect("a cloud"),
        );
        tree.covering_radius = Some(CoveringRadius { radius: 0.1 + 0.2, proved });
        part.levels.push(tree);
    }
    let opened = open(&saved(&part)).expect("opened");
    assert_eq!(opened.levels.len(), 3);
    assert!(bits(&part) == bits(&opened));
    let rest = |part: &Part| {
        let of = |tree: &PointBvh| format!("{:?}{}{}", tree.frame, tree.leaf_size, tree.weight);
        part.levels.iter().map(|tree| (of(tree), tree.covering_radius)).collect::<Vec<_>>()
    };
    assert_eq!(rest(&part), rest(&opened));
    assert!(saved(&part) == saved(&opened), "the same part, the same bytes");
}

/// Checks that the part has its own memory: the file may be shortened, overwritten and removed.
#[test]
fn what_becomes_of_the_file_does_not_matter() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("tube.part");
    let poses = along_the_courses(100);
    let part = Part::from_mesh(&scenes::tube(), Sampling::new(3_000)).expect("a part");
    let expected = evaluations(&part, &poses);
    part.save(&path).expect("saved");
    let opened = Part::open(&path).expect("opened");
    let file = File::options().write(true).open(&path).expect("the file");
    file.set_len(0).expect("shortened");
    assert!(evaluations(&opened, &poses) == expected && bits(&opened) == bits(&part));
    fs::write(&path, vec![255; 200_000]).expect("overwritten");
    assert!(evaluations(&opened, &poses) == expected && bits(&opened) == bits(&part));
    fs::remove_file(&path).expect("removed");
    assert!(evaluations(&opened, &poses) == expected);
}

/// Checks that a file which becomes shorter during reading is refused.
#[test]
fn what_ends_while_it_is_read_is_refused() {
    let bytes = saved(&small());
    for end in [0, 10, 300, bytes.len() - 1] {
        assert!(read::part(&bytes[..end], bytes.len() as u64, "a.part").is_err(), "{end}");
    }
}

#[test]
fn lists_lie_at_multiples_of_64() {
    let part = small();
    let bytes = saved(&part);
    let tree = part.tree();
    let lists: [&[u8]; 4] = [
        bytemuck::cast_slice(&tree.levels[0]),
        bytemuck::cast_slice(&tree.leaves),
        bytemuck::cast_slice(&tree.attributes),
        bytemuck::cast_slice(&tree.triangles),
    ];
    for list in lists {
        assert!((0..bytes.len()).step_by(ALIGN).any(|at| bytes[at..].starts_with(list)));
    }
}

#[test]
fn lists_have_the_lengths_that_trees_have() {
    for points in [1, 15, 16, 17, 255, 256, 257, 4095, 4096, 4097, 65_537] {
        let tree = PointBvh::new(
            &Cloud::sample(&cuboid(), Sampling::monte_carlo(points)).expect("a cloud"),
        );
        let mut levels = 0;
        for (list, count) in lists(points as u64) {
            let found = match list {
                List::Boxes(level) => {
                    assert_eq!(level, levels);
                    levels += 1;
                    tree.levels[level].len()
                }
                List::Leaves => tree.leaves.len(),
                List::Skins => tree.attributes.len(),
                List::Triangles => tree.triangles.len(),
            };
            assert_eq!(found as u64, count, "{list} of {points}");
        }
        assert_eq!(levels, tree.levels.len());
    }
}

#[test]
fn what_cannot_be_written_leaves_the_old_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("old.part");
    small().save(&path).expect("saved");
    let full = || io::Error::from(io::ErrorKind::StorageFull);
    let failed = replace(&path, |out| out.write_all(b"half").and(Err(full())));
    assert_eq!(failed.expect_err("full").kind(), io::ErrorKind::StorageFull);
    Part::open(&path).expect("the old one");
    assert_eq!(fs::read_dir(folder.path()).expect("a folder").count(), 1, "nothing is left over");
    for nowhere in [folder.path().join("no/such.part"), folder.path().to_owned(), path.join("x")] {
        let said = small().save(&nowhere).expect_err("nowhere to write").to_string();
        let named = format!("cannot write {}: ", nowhere.display());
        assert!(said.starts_with(&named) && said.contains("the file is as it was"), "{said}");
    }
}

#[cfg(unix)]
#[test]
fn links_and_the_usual_permissions_stay() {
    use std::os::unix::fs::{MetadataExt, symlink};
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name);
    File::create(at("usual")).expect("a file");
    small().save(at("real.part")).expect("saved");
    symlink(at("real.part"), at("link.part")).expect("a link");
    small().save(at("link.part")).expect("saved");
    assert!(fs::symlink_metadata(at("link.part")).expect("a link").is_symlink());
    let mode = |name: &str| fs::metadata(at(name)).expect("a file").mode();
    assert_eq!(mode("real.part"), mode("usual"));
}
