//! Lowers a ball cutter onto a block: `cargo run --release -p touchoff --example first_contact`.

use nalgebra::{Point3, Vector3};
use touchoff::mesh::shapes;
use touchoff::{Part, Pose, Probe, Sampling, Unit, summary};

touchoff::include_tool!("examples/ball.tool");

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let low = Point3::new(-10.0, -10.0, -5.0);
    let block = shapes::cuboid(low, Point3::new(10.0, 10.0, 0.0), Unit::Millimetre)?;
    let part = Part::from_mesh(&block, Sampling::new(100_000))?;
    let mut probe = Probe::new(&part, &Ball);
    for step in 0..5 {
        let tip = Point3::new(0.0, 0.0, 0.1 - 0.1 * f64::from(step));
        let pose = Pose::from_axis(tip, Vector3::z())?;
        let evaluation = probe.wrench(&pose);
        println!(
            "tip at {:5.2}: {:4} points, {:.3} mm deep, pushed up by {:.4}, niceness {:?}",
            tip.z,
            evaluation.colliding,
            evaluation.depth(),
            evaluation.force.z,
            evaluation.niceness,
        );
        if let Some(depths) = summary(probe.contacts(&pose), |contact| contact.depth) {
            println!("               mean depth {:.3} mm", depths.mean);
        }
    }
    Ok(())
}
