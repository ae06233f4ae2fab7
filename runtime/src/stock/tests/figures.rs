//! Times and sizes, printed with `--nocapture`. Their limits are far above what is measured, for slow
//! machines.

use super::*;
use crate::certify::TriangleBvh;
use crate::program::Program;
use std::time::Instant;

#[test]
fn figures() {
    let start = Instant::now();
    let mut stock = block([0.0, 0.0, -20.0], [100.0, 60.0, 0.0], 0.4);
    let built = start.elapsed().as_secs_f64();
    let points = stock.len();
    let tree = &stock.tree;
    let boxes: usize = tree.levels.iter().map(|level| size_of_val(&level[..])).sum();
    let lists = size_of_val(&tree.leaves[..]) + size_of_val(&tree.triangles[..]) + boxes;
    let bytes = (lists + stock.initial.bytes()) as f64 / points as f64;
    println!(
        "{points} points, {bytes:.1} bytes per point, {:.1e} points per second built",
        points as f64 / built
    );
    assert!(bytes < 20.0);

    // Motions far from the stock, and closely above it.
    for (name, height) in [("100 mm above the stock", 100.0), ("0.5 mm above the stock", 0.5)] {
        let poses = [-10.0, 110.0].map(|x| upright([x, 30.0, height]));
        let count = 2000;
        let start = Instant::now();
        for _ in 0..count {
            assert_eq!(advance(&mut stock, &Ball, poses, MotionMode::Rapid, 0.01), []);
        }
        let time = start.elapsed().as_secs_f64() / f64::from(count);
        println!("a motion of 120 mm {name}: {:.2} µs", 1e6 * time);
        assert!(time < 1e-3);
    }

    // Pockets: lines at a distance of 3 mm, 2 mm deeper each time.
    for depth in [-2.0, -4.0, -6.0] {
        let (before, start) = (stock.len(), Instant::now());
        let mut samples = 0.0;
        for line in 0..18 {
            let y = 4.0 + 3.0 * f64::from(line);
            let poses = [-4.0, 104.0].map(|x| upright([x, y, depth]));
            let contacts = advance(&mut stock, &Mill, poses, MotionMode::Feed, 0.01);
            assert_eq!(contacts, []);
            samples += 108.0 / stock.step();
        }
        let time = start.elapsed().as_secs_f64();
        let removed = (before - stock.len()) as f64;
        println!(
            "pocket at {depth} mm: {removed} points removed, {:.2e} per second; {:.1} µs per sample of {:.1} points",
            removed / time,
            1e6 * time / samples,
            removed / samples
        );
        assert!(removed > 1e4 && removed / time > 1e4);
    }
    // The same motions once more, with nothing left to cut.
    let start = Instant::now();
    for line in 0..18 {
        let y = 4.0 + 3.0 * f64::from(line);
        let poses = [-4.0, 104.0].map(|x| upright([x, y, -6.0]));
        assert_eq!(advance(&mut stock, &Mill, poses, MotionMode::Feed, 0.01), []);
    }
    let samples = 18.0 * 108.0 / stock.step();
    println!(
        "in the empty pocket: {:.2} µs per sample",
        1e6 * start.elapsed().as_secs_f64() / samples
    );
}

/// A program from a file, in a block around its part: the ball that it is for cuts the flanks of the blades.
#[test]
fn figures_of_a_program() {
    crate::tool! {
        tool D2Ball "a ball of 2 mm under a long flute" {
            units mm;
            profile {
                start (0, 0);
                arc to (1, 1) center (0, 1) as ball cutting;
                line to (1, 30) as flute cutting;
                line to (1, 60), (0, 60) as shank;
            }
            niceness cutting: 1;
        }
    }
    let files = ["parts/impeller.stl", "paths/impeller_flank.apt"].map(shared);
    let [Some(part), Some(program)] = files else { return };
    let part = Mesh::read_stl(part, UNIT).expect("a part");
    let program = Program::read(program).expect("a program");
    let mut stock = Stock::from_box(part.bounds(), 0.5, UNIT).expect("a stock");
    let points = stock.len();
    let (mut contacts, mut begun) = (0, 0);
    let start = Instant::now();
    for pair in program.locations.windows(2) {
        let mode = if pair[1].rapid { MotionMode::Rapid } else { MotionMode::Feed };
        let poses = [pair[0].pose, pair[1].pose];
        let found = advance(&mut stock, &D2Ball, poses, mode, 0.1);
        contacts += found.len();
        begun += found.iter().filter(|contact| !contact.continued).count();
    }
    let time = start.elapsed().as_secs_f64();
    let motions = program.locations.len() - 1;
    println!(
        "{motions} motions in {points} points: {:.1} ms, {:.1} µs per motion; {} points removed, {contacts} contacts \
         of which {begun} begin",
        1e3 * time,
        1e6 * time / motions as f64,
        points - stock.len()
    );
    let bvh = TriangleBvh::new(&part);
    let start = Instant::now();
    let comparison = stock.compare(&bvh).expect("compared");
    println!(
        "comparison: {} points over the part, {} gouges, {:.0} ms",
        comparison.excess.len(),
        comparison.gouges.len(),
        1e3 * start.elapsed().as_secs_f64()
    );
    let start = Instant::now();
    let mesh = stock.remaining_mesh().expect("a mesh");
    println!(
        "mesh: {} triangles, {:.0} ms",
        mesh.triangles().len(),
        1e3 * start.elapsed().as_secs_f64()
    );
    assert!(stock.len() < points && mesh.diagnostics().is_solid());
}
