//! A job built in memory: a G-code program on a 3-axis machine, a part of twelve triangles, a clamp and stock.

use nalgebra::Point3;
use std::error::Error;
use touchoff::certify::TriangleBvh;
use touchoff::mesh::shapes;
use touchoff::{Mesh, Unit};
use touchoff_verify::gcode::{ControlRules, ControlSetup};
use touchoff_verify::job::{Body, JobStock, StockShape};
use touchoff_verify::machine::Machine;
use touchoff_verify::{Job, JobTool, Program};

touchoff::tool! {
    tool EndMill "12 mm across, 20 mm of it cut, in a holder 50 mm wide" {
        units mm;
        profile {
            start (0, 0); line to (6, 0) as face cutting; line to (6, 20) as flute cutting;
            line to (6, 45) as shank; line to (25, 45), (25, 90), (0, 90) as holder;
        }
        niceness cutting: 1;
    }
}

/// A pass along the wall, one point of it 0.05 mm in the wall, and a retract that is too low to cross it.
const PROGRAM: &str = "G21 G90 G54 G61\nT1 M6\nS2000 M3\nG0 X-12. Y-70.\nG43 H1 Z12.\nG1 X-6. F800.\nY0.\nX-5.95 Y40.\n\
                       X-6. Y80.\nG0 Z25.\nX40. Y0.\nG0 Z90.\nM30\n";

/// Checks the program, and prints findings, what was not checked, and the verdict.
pub(crate) fn check() -> Result<(), Box<dyn Error>> {
    // A wall from its vertices and triangles, a clamp beyond it, and the box that both are cut from.
    let vertices = [0., 20.].map(|x| [-60., 60.].map(|y| [0., 30.].map(|z| Point3::new(x, y, z))));
    let triangles = [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1]];
    let others = [[2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]];
    let triangles = triangles.into_iter().chain(others);
    let wall = Mesh::new(vertices.into_iter().flatten().flatten(), triangles, Unit::Millimetre)?;
    let clamp = [Point3::new(30., -10., 0.), Point3::new(50., 10., 40.)];
    let [wall, clamp] = [wall, shapes::cuboid(clamp[0], clamp[1], Unit::Millimetre)?]
        .map(|mesh| TriangleBvh::new(&mesh));

    let setup = ControlSetup { rules: ControlRules::named("linuxcnc")?, ..ControlSetup::default() };
    let program = Program::parse(PROGRAM, "wall.nc", Machine::named("3-axis")?, &setup)?;
    let mut job = Job::new(&program, &wall);
    job.tools.push(JobTool::numbered(1, &EndMill));
    job.bodies.push(Body::fixture("the clamp", &clamp));
    job.tolerance = 0.01;
    let corners = [Point3::new(-1., -60., 0.), Point3::new(21., 60., 30.)];
    job.stock = Some(JobStock { shape: StockShape::Box(corners), spacing: 0.5, tolerance: None });

    let report = job.check(&|_| ())?;
    for finding in report.findings() {
        println!("{}:{}: {}", program.name(), finding.line, finding.text);
    }
    report.gaps.iter().for_each(|gap| println!("not checked: {gap}"));
    println!("{:?}: {}", report.verdict(), report.summaries().join("; "));
    Ok(())
}
