//! What a scene skips: parts that are far, and frames in which nothing moved.

use crate::asked::{asked, felt, wrench};
use crate::contender::Contender;
use crate::line::{Row, Setting, agree, trial};
use crate::passes::BLOCK;
use crate::turns::{Along, Clock, Variant, block_of, turns};
use nalgebra::Point3;
use std::hint::black_box;
use tools_library::Fig73;
use touchoff::mesh::shapes;
use touchoff::scenes::{HEIGHT, INNER, OUTER, Path, apart};
use touchoff::{Cloud, Part, Pose, Probe, Scene, Tool, ToolId, Unit};

/// Parts that are not touched.
const OTHERS: usize = 9;
/// Parts are built anew for this scene: of more points they would take long, and much memory.
const MOST_POINTS: usize = 100_000;
/// How deep the ball is in the wall of the part that is touched, and how far from the others', mm.
const DEPTH: f64 = 0.05;
const GAP: f64 = 0.1;
/// How far what is far is, mm.
const FAR: f64 = 200.0;

/// A tool far from the part, and so near that the part is walked but not touched.
pub(crate) fn far_part(setting: &Setting) -> Vec<Row> {
    if setting.path != Path::Outside {
        return Vec::new();
    }
    let count = setting.poses.len();
    let mut methods = [FAR, GAP].map(|_| wrench(Probe::new(setting.part, &Fig73)));
    let poses = [FAR, GAP].map(|gap| (0..count).map(|k| apart(gap, k, count)).collect::<Vec<_>>());
    for (method, poses) in methods.iter_mut().zip(&poses) {
        assert!(poses.iter().all(|pose| method.query(pose).colliding == 0), "nothing is touched");
    }
    let [far, near] = &mut methods;
    let mut far = Along { method: far, poses: &poses[0] };
    let mut near = Along { method: near, poses: &poses[1] };
    let sums = turns([&mut far, &mut near], count.div_ceil(BLOCK), Clock::Quieter);
    vec![Row { scene: "apart", ..setting.row("wrench", sums.map(|sum| sum / count as f64)) }]
}

/// One part touched, nine others far, or so near that they are walked but not touched.
pub(crate) fn far_parts(setting: &Setting) -> Vec<Row> {
    let points = setting.part.tree().len();
    if setting.path != Path::Outside || points > MOST_POINTS {
        return Vec::new();
    }
    let thinner = shapes::tube(INNER, OUTER - DEPTH - GAP, HEIGHT, 1024, 1, Unit::Millimetre)
        .expect("a tube by construction");
    let others: Vec<Part> = (0..OTHERS as u64)
        .map(|seed| Cloud::random(&thinner, points, seed).expect("the tube has a surface"))
        .map(|cloud| Part::from_cloud(&cloud))
        .collect();
    let [mut alone, mut far, mut near] = [(0, 0.0), (OTHERS, FAR), (OTHERS, 0.0)]
        .map(|(count, away)| beside(setting.part, &others[..count], away));
    let count = setting.poses.len();
    let poses: Vec<Pose> = (0..count).map(|k| apart(-DEPTH, k, count)).collect();
    let mut colliding = 0;
    for pose in &poses {
        let felt = alone.query(pose);
        colliding += felt.colliding;
        agree("far parts", pose, &felt, &far.query(pose));
        agree("near parts", pose, &felt, &near.query(pose));
    }
    assert!(colliding > 0, "the one part is touched");
    let [mut alone, mut far, mut near]: [Along; 3] =
        [&mut alone as &mut dyn Contender, &mut far, &mut near]
            .map(|method| Along { method, poses: &poses });
    let blocks = count.div_ceil(BLOCK);
    let [alone, far, near] = turns([&mut alone, &mut far, &mut near], blocks, Clock::Quieter);
    let a_part = |sum: f64| (sum - alone) / (count * OTHERS) as f64;
    vec![Row { scene: "wall", ..setting.row("a part more", [a_part(far), a_part(near)]) }]
}

/// A scene of the part and of others about it, so far away.
fn beside<'a>(part: &'a Part, others: &'a [Part], away: f64) -> impl Contender + use<'a> {
    let mut scene = Scene::new(Unit::Millimetre);
    let add = |scene: &mut Scene<'a>, part, place| {
        scene.add_part(part, place).expect("parts and scene are in millimetres");
    };
    add(&mut scene, part, Pose::default());
    for (other, k) in others.iter().zip(1..) {
        // Turned about its own axis a tube is where it was, but the scene has a place to look from.
        let angle = 0.5 * f64::from(k);
        let tip = Point3::new(away * angle.cos(), away * angle.sin(), 0.0);
        let turn = [0.0, 0.0, (angle / 2.0).sin(), (angle / 2.0).cos()];
        add(&mut scene, other, Pose::from_quaternion(tip, turn).expect("a unit quaternion"));
    }
    let tool = scene.add_tool(&Fig73);
    asked("scene", move |pose| {
        scene.move_tool(tool, *pose);
        felt(&scene.wrench(tool))
    })
}

/// The answer asked for again, at as many poses as a block has: each has a tool of its own.
struct Still<'a> {
    scene: Scene<'a>,
    tools: [ToolId; BLOCK],
    poses: &'a [Pose],
}

impl Variant for Still<'_> {
    fn ready(&mut self, block: usize) {
        for (pose, tool) in block_of(self.poses, block).iter().zip(self.tools) {
            self.scene.move_tool(tool, *pose);
            black_box(self.scene.wrench(tool).colliding);
        }
        // To compute the answers took the caches that a frame without motion finds full of them.
        black_box(self.run(block));
    }

    fn run(&mut self, block: usize) -> usize {
        let tools = &self.tools[..block_of(self.poses, block).len()];
        tools.iter().map(|tool| self.scene.wrench(*tool).colliding).sum()
    }
}

/// The last frame's answer, and the same computed anew.
pub(crate) fn still(setting: &Setting) -> Vec<Row> {
    let tool: &dyn Tool = black_box(&Fig73);
    let mut anew = wrench(Probe::new(setting.part, tool));
    // To get ready, the scene computes each answer once, as well as the probe.
    let poses = setting.some(2.0 * trial(&mut anew, &setting.poses));
    let mut scene = Scene::new(setting.part.unit());
    scene.add_part(setting.part, Pose::default()).expect("the scene is in the part's unit");
    let tools = std::array::from_fn(|_| scene.add_tool(tool));
    let mut still = Still { scene, tools, poses: &poses };
    let blocks = poses.len().div_ceil(BLOCK);
    for block in 0..blocks {
        still.ready(block);
        for (pose, tool) in block_of(&poses, block).iter().zip(tools) {
            agree("still", pose, &felt(&still.scene.wrench(tool)), &anew.query(pose));
        }
    }
    let mut anew = Along { method: &mut anew, poses: &poses };
    let sums = turns([&mut still, &mut anew], blocks, Clock::Quieter);
    vec![setting.row("wrench", sums.map(|sum| sum / poses.len() as f64))]
}
