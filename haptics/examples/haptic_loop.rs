//! Simulates a hand that presses a ball onto a block for three seconds at 1000 cycles per second, while another
//! thread watches: `cargo run --release -p touchoff-haptics --example haptic_loop`.

use nalgebra::{Point3, Vector3};
use std::sync::atomic::AtomicBool;
use std::time::Duration;
use touchoff::mesh::shapes;
use touchoff::{Law, Part, Pose, Probe, Sampling, Unit};
use touchoff_haptics::{
    Device, DeviceLimits, MonotonicClock, Realtime, Session, SessionSettings, SimulatedHand,
    Tremor, state_channel,
};

touchoff::include_tool!("examples/ball.tool");

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (low, high) = (Point3::new(-20., -20., -10.), Point3::new(20., 20., 0.));
    let part =
        Part::from_mesh(&shapes::cuboid(low, high, Unit::Millimetre)?, Sampling::new(20_000))?;
    let probe = Probe::new(&part, &Ball).with_law(Law::Gradient);

    let (rate, cycles) = (1000.0, 3000);
    let tremor = Tremor { size: 0.02, frequency: 10.0, seed: 1 };
    let upright = |z| Pose::from_axis(Point3::new(0.0, 0.0, z), Vector3::z());
    let (above, pressed) = (upright(1.0)?, upright(-2.0)?);
    let target_pose = move |time: f64| if time.fract() < 0.5 { above } else { pressed };
    let mut hand =
        SimulatedHand::new(DeviceLimits::default(), rate, target_pose)?.with_tremor(&tremor)?;
    let mut session = Session::new(probe, &SessionSettings::new(rate), hand.limits())?;

    let (mut publisher, mut latest, samples) = state_channel(10_000);
    let stop = AtomicBool::new(false);
    let report = std::thread::scope(|scope| {
        let session_thread = scope.spawn(|| {
            for refused in (Realtime { priority: Some(80), core: None, locked: true }).apply() {
                eprintln!("{refused}");
            }
            let clock = &mut MonotonicClock::new(Duration::from_micros(60));
            session.run(&mut hand, clock, cycles, &mut publisher, &stop)
        });
        while !session_thread.is_finished() {
            std::thread::sleep(Duration::from_millis(250));
            if let Some(state) = latest.read() {
                let (tip, force) = (state.tool.tip(), state.wrench_on_hand.force);
                println!("tip at {:.3} mm, {:.3} N up", tip.z, force.z);
            }
        }
        session_thread.join().expect("the loop panics at nothing")
    });
    println!(
        "{} cycles, {} missed, half of them within {:.1} µs; {} states recorded",
        report.cycles,
        report.missed,
        report.durations.value_at_quantile(0.5) as f64 / 1e3,
        samples.count(),
    );
    Ok(())
}
