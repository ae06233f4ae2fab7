//! The page `programs.md`: time and memory of the check of long G-code programs.

use clap::Args;
use std::error::Error;
use std::fmt::Write;
use std::time::Instant;
use touchoff::certify::TriangleBvh;
use touchoff::mesh::shapes;
use touchoff::{Mesh, Unit};
use touchoff_bench::page::{Page, Section};
use touchoff_tools::BallEr16;
use touchoff_verify::gcode::{Choice, ControlRules, ControlSetup, Rule};
use touchoff_verify::machine::Machine;
use touchoff_verify::{MachineProgram, ToolSelection, Verifier};

/// Times the check of long programs, and measures its memory.
#[derive(Args)]
pub(crate) struct Programs {
    /// Numbers of blocks of the programs, separated by commas.
    #[arg(
        long,
        value_name = "N,M,…",
        value_delimiter = ',',
        default_value = "10000,100000,1000000"
    )]
    blocks: Vec<usize>,
}

/// A machine, and the motion that a program makes on it.
#[derive(Clone, Copy)]
enum Scene {
    ThreeAxes,
    Joints,
    TipControl,
}

impl Scene {
    const ALL: [Scene; 3] = [Scene::ThreeAxes, Scene::Joints, Scene::TipControl];

    fn name(self) -> &'static str {
        match self {
            Scene::ThreeAxes => "3 axes",
            Scene::Joints => "5 axes",
            Scene::TipControl => "5 axes, TCP",
        }
    }

    fn machine(self) -> &'static str {
        match self {
            Scene::ThreeAxes => "3-axis",
            Scene::Joints | Scene::TipControl => "A-C trunnion",
        }
    }

    /// Returns a program that circles above the part, with an arc in every tenth block.
    fn program(self, blocks: usize) -> Result<String, std::fmt::Error> {
        let mut text = String::from("G21 G90 G17\nT1 M6\n");
        text += match self {
            Scene::ThreeAxes => "G43 H1\nG0 X60. Y0. Z45.\n",
            Scene::Joints => "G43 H1\nG0 X60. Y0. Z45. A0. C0.\n",
            Scene::TipControl => "G43.4 H1\nG0 X60. Y0. Z45. A0. C0.\n",
        };
        text += "F1000.\n";
        for index in 0..blocks {
            let angle = 1e-3 * index as f64;
            let (sine, cosine) = angle.sin_cos();
            let [x, y] = [60.0 * cosine, 60.0 * sine];
            if index % 10 == 9 {
                writeln!(text, "G3 X{x:.3} Y{y:.3} R200.")?;
                continue;
            }
            write!(text, "N{index} G1 X{x:.4} Y{y:.4} Z{:.4}", 45.0 + sine)?;
            match self {
                Scene::ThreeAxes => writeln!(text)?,
                Scene::Joints | Scene::TipControl => {
                    writeln!(text, " A{:.3} C{:.3}", -10.0 * sine.abs(), 30.0 * sine)?;
                }
            }
        }
        text += "M30\n";
        Ok(text)
    }
}

impl Programs {
    pub(crate) fn run(&self) -> Result<Option<Page>, Box<dyn Error>> {
        let part = shapes::tube(8.0, 10.0, 30.0, 120, 110, Unit::Millimetre)?;
        let bvh = TriangleBvh::new(&part);
        let mut body = introduction(&part);
        for scene in Scene::ALL {
            for blocks in &self.blocks {
                body += &row(&bvh, scene, *blocks)?;
            }
        }
        Ok(Some(Page {
            name: "programs",
            title: "How long the check of a program takes",
            covers: &[
                "runtime/src/bvh",
                "runtime/src/certify",
                "verify/src/gcode",
                "verify/src/machine",
                "runtime/src/motion.rs",
                "runtime/src/pose.rs",
                "runtime/src/tool",
                "verify/src/check",
            ],
            sections: vec![Section { title: "", body }],
            figures: Vec::new(),
        }))
    }
}

fn introduction(part: &Mesh) -> String {
    format!(
        "Programs circle above a tube of {} triangles with `BallEr16`, and touch nothing; every tenth block is an arc. *Read* is the \
         interpreter and the machine's kinematics, *checked* the proof that no motion comes near, which interprets the program \
         again. *Peak* is the largest memory of the process up to then, which contains the text and what earlier rows needed. \
         Both cores are used.\n\n\
         | program | blocks | motions | text, MB | read, s | checked, s | per motion, µs | peak, MB |\n\
         |---|--:|--:|--:|--:|--:|--:|--:|\n",
        part.triangles().len()
    )
}

fn row(bvh: &TriangleBvh, scene: Scene, blocks: usize) -> Result<String, Box<dyn Error>> {
    // G43.4 is no word of LinuxCNC.
    let rules = ControlRules::named("linuxcnc")?.with(Rule::Dialect, Choice::Iso);
    let mut setup = ControlSetup { rules, ..ControlSetup::default() };
    setup.work_offsets[0] = Some([0.0, 0.0, -480.0, 0.0, 0.0, 0.0]);
    setup.lengths.insert(1, 120.0);
    let text = scene.program(blocks)?;
    let size = text.len();
    let start = Instant::now();
    let program = MachineProgram::new("long.nc", text, Machine::named(scene.machine())?, setup)?;
    let read = start.elapsed();
    let verifier = Verifier::new(bvh, &BallEr16)?;
    let moves = program.moves(ToolSelection::All, None, Unit::Millimetre)?;
    let start = Instant::now();
    let report = verifier.check_moves(moves, &|_| ())?;
    let checked = start.elapsed();
    if !report.findings.is_empty() {
        return Err(format!("{}: {} findings", scene.name(), report.findings.len()).into());
    }
    let per_motion = 1e6 * (read + checked).as_secs_f64() / report.motions as f64;
    Ok(format!(
        "| {} | {blocks} | {} | {:.1} | {:.2} | {:.2} | {per_motion:.1} | {} |\n",
        scene.name(),
        report.motions,
        size as f64 / 1e6,
        read.as_secs_f64(),
        checked.as_secs_f64(),
        peak_memory().map_or("unknown".to_owned(), |peak| format!("{:.0}", peak / 1e6)),
    ))
}

/// Returns the largest memory that the process has had, in bytes, if the system tells.
fn peak_memory() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    Some(1024.0 * line.trim().strip_suffix("kB")?.trim().parse::<f64>().ok()?)
}
