//! The results of a session: its state while it runs, and its report.

use crate::arguments::Haptic;
use crate::failure::Failure;
use crate::output::Output;
use serde::Serialize;
use std::io::Write;
use touchoff_haptics::{ContactStiffness, LatencyHistogram, LoopReport, SessionState};

/// Prints the current state on one line.
pub(super) fn show(state: &SessionState, rate: f64) {
    let [x, y, z] = [0, 1, 2].map(|k| state.tool.tip()[k]);
    message!(
        "{:>8.2} s  tip {x:>9.3} {y:>9.3} {z:>9.3}  depth {:>7.4}  force {:>7.3} N  torque {:>8.2} N·mm",
        state.cycle as f64 / rate,
        state.wrench.depth(),
        state.wrench_on_hand.force.norm(),
        state.wrench_on_hand.torque.norm(),
    );
}

/// The report of a run, for programs.
#[derive(Serialize)]
struct RunSummary<'a> {
    device: &'a str,
    rate_hz: f64,
    cycles: u64,
    missed_deadlines: u64,
    skipped_cycles: u64,
    stalls: u64,
    cycle_time_ns: Quantiles,
    start_delay_ns: Quantiles,
    /// In N and in N·mm.
    peak_force: f64,
    peak_torque: f64,
    /// In N·mm.
    energy_in: f64,
    energy_stored: f64,
    energy_generated: f64,
    energy_dissipated: f64,
    faults: FaultCounts,
    dropped_states: u64,
    law: String,
    /// Force in N per unit of the law's force.
    stiffness: f64,
    /// The stiffness with the reason for it.
    stiffness_reason: String,
    /// The depth to which the device's largest force presses the tool into a plane, in the part's unit.
    depth_at_max_force: Option<f64>,
    /// The thinnest place of the part that was found, in its unit.
    least_thickness: Option<f64>,
}

/// Numbers of cycles with a fault of the device.
#[derive(Serialize)]
struct FaultCounts {
    no_pose: u64,
    jumps: u64,
    not_responding: u64,
    failed_writes: u64,
}

#[derive(Serialize)]
struct Quantiles {
    p50: u64,
    p99: u64,
    p999: u64,
    max: u64,
}

impl Quantiles {
    fn of(times: &LatencyHistogram) -> Quantiles {
        let [p50, p99, p999] = [0.5, 0.99, 0.999].map(|share| times.value_at_quantile(share));
        Quantiles { p50, p99, p999, max: times.max() }
    }

    fn format(&self) -> String {
        let [p50, p99, p999, max] =
            [self.p50, self.p99, self.p999, self.max].map(|ns| ns as f64 / 1e3);
        format!("median {p50:.1}, p99 {p99:.1}, p99.9 {p999:.1}, max {max:.1}")
    }
}

/// Prints the report as one JSON object.
pub(super) fn print_json(
    report: &LoopReport,
    arguments: &Haptic,
    contact: &ContactStiffness,
) -> Result<(), Failure> {
    let energy = report.last.map(|state| state.energy).unwrap_or_default();
    let faults = report.faults;
    let summary = RunSummary {
        device: arguments.device.name(),
        rate_hz: arguments.rate,
        cycles: report.cycles,
        missed_deadlines: report.missed,
        skipped_cycles: report.skipped,
        stalls: report.stalls,
        cycle_time_ns: Quantiles::of(&report.durations),
        start_delay_ns: Quantiles::of(&report.start_delays),
        peak_force: report.peak_wrench[0],
        peak_torque: report.peak_wrench[1],
        energy_in: energy.input,
        energy_stored: energy.stored,
        energy_generated: energy.generated,
        energy_dissipated: energy.dissipated,
        faults: FaultCounts {
            no_pose: faults.no_pose,
            jumps: faults.jumps,
            not_responding: faults.not_responding,
            failed_writes: faults.failed_writes,
        },
        dropped_states: report.dropped_states,
        law: arguments.law.to_string(),
        stiffness: contact.stiffness,
        stiffness_reason: contact.reason(),
        depth_at_max_force: contact.depth,
        least_thickness: contact.thin.map(|thin| thin.thickness),
    };
    let mut out = Output::lines();
    out.json(&summary)?;
    Ok(out.flush()?)
}

/// Prints the report as text.
pub(super) fn print_text(
    report: &LoopReport,
    arguments: &Haptic,
    contact: &ContactStiffness,
) -> Result<(), Failure> {
    let mut out = Output::lines();
    let energy = report.last.map(|state| state.energy).unwrap_or_default();
    let faults = report.faults;
    let LoopReport { cycles, missed, skipped, stalls, .. } = report;
    let of = arguments.rate;
    writeln!(
        out,
        "{cycles} cycles at {of} Hz, {missed} missed their deadline, {skipped} skipped; law {}",
        arguments.law
    )?;
    writeln!(out, "  stiffness:        {}", contact.reason())?;
    writeln!(out, "  cycle time, µs:   {}", Quantiles::of(&report.durations).format())?;
    writeln!(out, "  start delay, µs:  {}", Quantiles::of(&report.start_delays).format())?;
    let [force, torque] = report.peak_wrench;
    writeln!(out, "  peak:             {force:.3} N, {torque:.2} N·mm")?;
    writeln!(
        out,
        "  energy, N·mm:     {:.4} in, {:.4} stored at the end; at most {:.2e} generated, {:.2e} dissipated",
        energy.input, energy.stored, energy.generated, energy.dissipated,
    )?;
    let wrong = [
        (faults.no_pose, "cycles without a pose"),
        (faults.jumps, "jumps of the device"),
        (faults.not_responding, "cycles without a response"),
        (faults.failed_writes, "failed writes of the wrench"),
        (*stalls, "stalls of clock or thread"),
        (report.dropped_states, "states not recorded"),
    ];
    for (count, what) in wrong.into_iter().filter(|(count, _)| *count > 0) {
        writeln!(out, "  {count} {what}")?;
    }
    Ok(out.flush()?)
}
