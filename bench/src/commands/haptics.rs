//! The page `haptics.md` and its plots: the haptic loop.

use clap::Args;
use std::error::Error;
use touchoff::scenes::tube;
use touchoff::{Law, Part, Sampling};
use touchoff_bench::haptics::latency;
use touchoff_bench::haptics::page::{Measurements, page, plots};
use touchoff_bench::haptics::roughness::{Case, ForceStats, HandPath, force_stats, tools};
use touchoff_bench::haptics::wall;
use touchoff_bench::page::{Page, Section};
use touchoff_haptics::{EnergyBalance, Rendering};
use touchoff_tests::haptics::{block, energy, sheet};

/// Measures the haptic loop: stable wall stiffness, force roughness, energy, a thin sheet and latencies.
#[derive(Args)]
pub(crate) struct Haptics {
    /// Measures a small sample instead of the full set.
    #[arg(long)]
    quick: bool,
    /// Duration of each latency measurement, in seconds; at the higher rate a tenth of it.
    #[arg(long, value_name = "SECONDS", default_value_t = 10.0, value_parser = super::not_negative)]
    latency: f64,
}

impl Haptics {
    pub(crate) fn run(&self) -> Result<Option<Page>, Box<dyn Error>> {
        let rates: &[f64] = match self.quick {
            true => &[1000.0],
            false => &[250.0, 500.0, 1000.0, 2000.0, 5000.0, 10_000.0, 40_000.0],
        };
        let measured = Measurements {
            walls: rates.iter().map(|rate| wall::row(*rate)).collect(),
            roughness: roughness_rows(self.quick)?,
            pressing: pressing_rows(),
            tapping: tapping_rows(),
            latency: {
                // At five times the rate, a tenth of the time.
                let rates: &[f64] = if self.quick { &[1.0] } else { &[1.0, 5.0] };
                let run = |factor: &f64| {
                    let seconds = if *factor > 1.0 { self.latency / 10.0 } else { self.latency };
                    (1000.0 * factor, seconds, latency::measure(1000.0 * factor, seconds))
                };
                rates.iter().map(run).collect()
            },
        };
        let figures = plots(&measured).into_iter();
        Ok(Some(Page {
            name: "haptics",
            title: "The haptic loop",
            covers: &[
                "runtime/src/bvh",
                "runtime/src/cloud",
                "haptics/src",
                // Declarations only.
                ":!haptics/src/lib.rs",
                "runtime/src/part.rs",
                "runtime/src/point_bvh",
                "runtime/src/pose.rs",
                "runtime/src/probe",
                "runtime/src/tool",
            ],
            sections: vec![Section { title: "", body: page(&measured)? }],
            figures: figures.map(|(name, plot)| (name.to_owned(), plot)).collect(),
        }))
    }
}

type RoughnessRow = (usize, Case<'static>, ForceStats);

fn roughness_rows(quick: bool) -> Result<Vec<RoughnessRow>, Box<dyn Error>> {
    let mut rows = Vec::new();
    let [fig73, exact, smooth] = tools();
    let points: &[usize] = if quick { &[20_000] } else { &[1_000, 20_000, 400_000] };
    for count in points {
        let part = Part::from_mesh(&tube(), Sampling::new(*count))?;
        let mut add = |movement, tool, law, rendering, stiffness| {
            let case = Case { path: movement, tool, law, rendering, stiffness };
            rows.push((*count, case, force_stats(&part, &case)));
        };
        for law in [Law::Thesis, Law::Gradient] {
            for rendering in ["direct", "coupled"] {
                add(HandPath::Wall, exact, law, rendering, 3.0);
                for tool in [fig73, exact, smooth] {
                    add(HandPath::Edge, tool, law, rendering, 3.0);
                }
            }
            for rendering in ["direct", "scaled", "coupled"] {
                add(HandPath::Wall, exact, law, rendering, 300.0);
            }
        }
    }
    Ok(rows)
}

fn tapping_rows() -> Vec<(&'static str, Vec<EnergyBalance>)> {
    let part = block(20_000);
    let direct = Some(Rendering::Direct { scaled: false, damping: 0.0 });
    vec![
        ("direct", energy::tapping_energy(&part, 2.0, direct, false)),
        ("direct, controlled", energy::tapping_energy(&part, 2.0, direct, true)),
        ("coupled, controlled", energy::tapping_energy(&part, 2.0, None, true)),
    ]
}

fn pressing_rows() -> Vec<(&'static str, Vec<[f64; 3]>)> {
    let part = sheet::sheet_part();
    let direct = Some(Rendering::Direct { scaled: true, damping: 0.0 });
    vec![
        ("thesis, direct", sheet::press_on_sheet(&part, Law::Thesis, direct)),
        ("facing, direct", sheet::press_on_sheet(&part, Law::Facing, direct)),
        ("gradient, direct", sheet::press_on_sheet(&part, Law::Gradient, direct)),
        ("gradient, coupled", sheet::press_on_sheet(&part, Law::Gradient, None)),
    ]
}
