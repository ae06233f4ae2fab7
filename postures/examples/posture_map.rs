//! Leads a tool along a sphere by hand, leaning it back and forth, and keeps the acceptable postures per
//! triangle: `cargo run --release -p touchoff-postures --example posture_map`.

use nalgebra::{Point3, Vector3};
use std::fs::File;
use std::io::BufWriter;
use std::sync::atomic::AtomicBool;
use touchoff::certify::TriangleBvh;
use touchoff::mesh::shapes;
use touchoff::{Part, Pose, Probe, Sampling, Unit};
use touchoff_haptics::{
    DeviceLimits, ScriptedDevice, Session, SessionSettings, SimulatedClock, state_channel,
};
use touchoff_postures::{MapIdentity, PostureMap, Recorder, Rules, colormap};

touchoff::tool! {
    tool BallMill "a ball on a shank, in a holder" {
        units mm;
        profile {
            start (0, 0);
            arc to (3, 3) center (0, 3) as ball cutting;
            line to (3, 30) as shank;
            line to (12, 30), (12, 50), (0, 50) as holder;
        }
        niceness cutting: 1 - depth/3;
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mesh = shapes::sphere(20.0, 3, Unit::Millimetre)?;
    let (part, bvh) = (Part::from_mesh(&mesh, Sampling::new(50_000))?, TriangleBvh::new(&mesh));

    // The ball may be 0.05 mm deep; shank and holder may not be in the part.
    let rules = Rules { tolerance: 0.05, niceness: 0.5, allowed: Vec::new() };
    let identity = MapIdentity::new(&mesh, &[&BallMill], rules)?;
    let folder = tempfile::tempdir()?;
    let map = PostureMap::open(folder.path().join("sphere.postures"), &identity)?;

    // A device that plays a motion around the sphere, with the ball at most 0.05 mm in it.
    let limits = DeviceLimits { force: 1e3, stiffness: 1e3, ..DeviceLimits::default() };
    let (rate, cycles) = (1000.0, 20_000);
    let mut device = ScriptedDevice::new(limits, |cycle| {
        let time = cycle as f64 / rate;
        let (sin, cos) = (3.0 * time).sin_cos();
        let height = 0.1 * time - 1.0;
        let radius = (1.0 - height * height).max(0.0).sqrt();
        let outward = Vector3::new(radius * cos, radius * sin, height);
        let axis = (outward + 0.4 * Vector3::new(sin, cos, (5.0 * time).sin())).normalize();
        let tip = Point3::from(outward * (20.0 + 3.0 - 0.05) - axis * 3.0);
        Ok(Pose::from_axis(tip, axis)?)
    });
    let mut session =
        Session::new(Probe::new(&part, &BallMill), &SessionSettings::new(rate), limits)?;

    let (mut publisher, _, mut samples) = state_channel(cycles as usize);
    let (report, stats) = std::thread::scope(|scope| {
        // The publisher moves into the thread. When it is dropped, the recorder knows that the loop is over.
        let session_thread = scope.spawn(move || {
            let (clock, stop) = (&mut SimulatedClock::default(), AtomicBool::new(false));
            session.run(&mut device, clock, cycles, &mut publisher, &stop)
        });
        let stats = Recorder::new(&map, &part, &bvh, &BallMill)
            .map_err(Box::<dyn std::error::Error>::from)
            .and_then(|mut recorder| Ok(recorder.follow(&mut samples)?));
        (session_thread.join().expect("the loop panics at nothing"), stats)
    });
    let stats = stats?;
    println!(
        "{} cycles; {} poses judged, {} of them acceptable",
        report.cycles, stats.judged, stats.accepted
    );
    let coverage = map.coverage()?;
    println!("{} of {} triangles have a posture", coverage.covered, coverage.triangles);

    let csv = folder.path().join("sphere.csv");
    map.write_csv(&mut BufWriter::new(File::create(&csv)?))?;
    let text = std::fs::read_to_string(&csv)?;
    text.lines().take(4).for_each(|line| println!("{line}"));
    let ply = File::create(folder.path().join("sphere.ply"))?;
    map.write_ply(&mut BufWriter::new(ply), &mesh, colormap)?;
    Ok(())
}
