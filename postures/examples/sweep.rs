//! Tries two tools at every triangle of a tube, and plans a path of one of them over the triangles that it
//! reaches.
//!
//! ```sh
//! cargo run --release -p touchoff-postures --example sweep
//! ```

use std::num::NonZeroU16;
use std::ops::ControlFlow;
use touchoff::certify::TriangleBvh;
use touchoff::{Tool, Unit, mesh::shapes};
use touchoff_postures::path::{PathRequest, Pattern};
use touchoff_postures::sweep::{PostureSweep, SweepStats};
use touchoff_postures::{Directions, Rules};
use touchoff_verify::{ClData, Verifier};

touchoff::tool! {
    tool Slim "2 mm ball, 25 mm long" {
        units mm;
        profile {
            start (0, 0);
            arc to (1, 1) center (0, 1) as ball cutting;
            line to (1, 4) as flute cutting;
            line to (1, 25), (0, 25) as shank;
        }
        niceness cutting: 1;
    }
}

touchoff::tool! {
    tool Stout "6 mm ball in a wide holder, 8 mm out of it" {
        units mm;
        profile {
            start (0, 0);
            arc to (3, 3) center (0, 3) as ball cutting;
            line to (3, 8) as flute cutting;
            line to (12, 8), (12, 30), (0, 30) as holder;
        }
        niceness cutting: 2;
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let tube = shapes::tube(3.0, 5.0, 13.0, 72, 8, Unit::Millimetre)?;
    let bvh = TriangleBvh::new(&tube);
    let tools: [&dyn Tool; 2] = [&Slim, &Stout];
    let directions = Directions::spread(100);
    let rules = Rules { tolerance: 0.02, niceness: 0.0, allowed: Vec::new() };
    let sweep = PostureSweep::new(
        &tube,
        &bvh,
        tools.to_vec(),
        &directions,
        rules.clone(),
        NonZeroU16::MIN,
    )?;

    let mut stats = SweepStats::default();
    let mut best = [0; 2];
    // Directions from which the slim tool reaches each triangle.
    let mut access = vec![Vec::new(); tube.triangles().len()];
    let batches: Vec<usize> = (0..sweep.batches()).collect();
    let _: ControlFlow<()> = sweep.run(&batches, |batch| {
        stats += batch.stats;
        for (triangle, row) in batch.rows {
            if let Some(record) = row.best.first() {
                best[usize::from(record.tool)] += 1;
            }
            access[triangle.index()].clone_from(&row.access[0].directions);
        }
        ControlFlow::Continue(())
    });
    println!("{} postures, {} of them acceptable", stats.postures(), stats.acceptable);
    println!("of {} triangles Slim is best at {}, Stout at {}", access.len(), best[0], best[1]);

    let pattern = Pattern { normal: [0.0, 0.0, 1.0], stepover: 1.0, step: 0.5 };
    let path = PathRequest {
        mesh: &tube,
        bvh: &bvh,
        stock: None,
        tool: &Slim,
        rules: &rules,
        directions: &directions,
        accessibility: &access,
        pattern: &pattern,
        max_tilt: std::f64::consts::PI,
        axis_limits: None,
    }
    .plan()?;
    println!(
        "a path of {} stops, {} of them on the surface",
        path.locations.len(),
        path.contact_points
    );
    let program = ClData::new("tube", Some(Unit::Millimetre), path.locations)?;
    let report = Verifier::new(&bvh, &Slim)?.with_tolerance(rules.tolerance)?.check(&program)?;
    println!("{} findings", report.findings.len());
    Ok(())
}
