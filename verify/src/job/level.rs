//! Ways of which only a level is known, and what is higher than it.
//!
//! The tool is nowhere below the level, wherever its other axes are. What it can meet is a set of points on a link of the machine, of
//! which it is the hull: the corners of a box around a mesh or the stock, or the ends of a solid of revolution.

use super::{Body, BodyFrame, BodyRole, Job, JobGap, JobStock, JobTool, RevolvedBody, STOCK};
use crate::check::CheckGap;
use crate::gcode::BlockLine;
use crate::machine::{Axis, Letter, Link, Machine, Setup, Side};
use crate::{BlindWay, Level, MachineProgram, MachineSummary, ToolSelection, TopWay};
use nalgebra::{Point3, Vector3};
use std::f64::consts::{PI, TAU};
use touchoff::Pose;

/// Rounding of heights, in the part's unit.
const LEVEL_ROUNDING: f64 = 1e-6;

/// Number of points on a circle that bounds a solid of revolution: its polygon is up to 0.5 % wider.
const CIRCLE_POINTS: u32 = 32;

/// A gap of a way by the name of what is higher.
type NamedGap = fn(String) -> JobGap;

/// Something that is in a way which is lower.
struct Obstacle<'a> {
    name: &'a str,
    /// The link with which it moves; `None` for the part, and what stands with it.
    link: Option<Link>,
    /// Points around it while all axes are at 0, in the part's unit.
    hull: Hull,
    /// Set for a fixture, which is in the way of a tool at the top of Z's travel, too.
    is_fixture: bool,
    met: Vec<Met>,
}

/// A thing on the tool's side that can meet an obstacle. Lengths are in the part's unit.
enum Met {
    /// The tool, or a body that Z carries with it: by how much its level has to be higher, which is the distance to keep and that by which
    /// a body hangs lower than the tip.
    Carried { margin: f64 },
    /// A body of the head that Z does not carry: its lowest Z of the machine, less the distance to keep.
    Still { ceiling: f64 },
}

/// Points around something, in a frame.
enum Hull {
    Part(Vec<Point3<f64>>),
    Machine(Vec<Point3<f64>>),
}

/// Where obstacles stand while all axes of a machine are at 0.
struct Setting<'a> {
    machine: &'a Machine,
    /// The pose of machine coordinates relative to the part, in its unit.
    part: Pose,
    /// Set if the origin of the part is stated.
    is_placed: bool,
}

impl Setting<'_> {
    /// Returns points in machine coordinates.
    fn on_machine(&self, hull: &Hull) -> Vec<Point3<f64>> {
        match hull {
            Hull::Machine(points) => points.clone(),
            Hull::Part(points) => {
                let turn = self.part.rotation().transpose();
                points.iter().map(|point| Point3::from(turn * (point - self.part.tip()))).collect()
            }
        }
    }

    /// Returns points in the part's frame.
    fn on_part(&self, hull: &Hull) -> Vec<Point3<f64>> {
        match hull {
            Hull::Part(points) => points.clone(),
            Hull::Machine(points) => {
                let place =
                    |point: &Point3<f64>| self.part.tip() + self.part.rotation() * point.coords;
                points.iter().map(place).collect()
            }
        }
    }

    /// Returns the height of Z of the machine as the first of some levels counts it: that of the base, or of the part if nothing moves it.
    fn base_height(&self, levels: &[Level], z: f64) -> f64 {
        match levels {
            [part] => {
                let points = self.on_part(&Hull::Machine(vec![Point3::new(0.0, 0.0, z)]));
                top(&points, &part.up)
            }
            _ => z,
        }
    }
}

impl Job<'_> {
    /// Returns the ways of each reading that are lower than a body or the stock: those to the first position and to a reference position
    /// that is not known, of which X and Y are not known at one of their ends, and so what is between, those of rotary axes at rates that
    /// are not known, those of an empty spindle, and those of a tool of unknown length at the top of Z's travel.
    pub(super) fn low_ways(&self) -> Vec<(BlockLine, JobGap)> {
        let Some(first) = self.program.readings().first() else { return Vec::new() };
        // A body of the head can hang lower than a short tool, or than the gauge point of an empty spindle.
        let [below_tips, below_nose] = [self.obstacles(self.shortest()), self.obstacles(0.0)];
        let setting = self.setting(first);
        let above = |obstacles: &[Obstacle<'_>], way: &BlindWay, least: f64| {
            let heights = obstacles.iter().filter_map(|obstacle| {
                Some((obstacle.name, self.height_above(obstacle, way, setting.as_ref())?))
            });
            let highest = heights.max_by(|one, other| one.1.total_cmp(&other.1));
            highest.filter(|(_, height)| *height > least).map(|(name, _)| name.to_owned())
        };
        let mut low = Vec::new();
        for reading in self.program.readings() {
            let MachineSummary { blind_ways, ways_home, rotary_ways, empty_ways, top_ways, .. } =
                reading.summary();
            // A tool may touch what it passes over, and the nose of a spindle may not.
            let kinds: [(_, _, NamedGap, _); 4] = [
                (blind_ways, &below_tips, |name| JobGap::LowWay { name }, LEVEL_ROUNDING),
                (ways_home, &below_tips, |name| JobGap::LowWayHome { name }, LEVEL_ROUNDING),
                (rotary_ways, &below_tips, rotary_gap, LEVEL_ROUNDING),
                (empty_ways, &below_nose, |name| JobGap::LowSpindle { name }, -LEVEL_ROUNDING),
            ];
            for (ways, obstacles, gap, least) in kinds {
                for (block, way) in ways {
                    low.extend(above(obstacles, way, least).map(|name| (*block, gap(name))));
                }
            }
            // Bodies that are not apart by the level of the tool can meet wherever it is.
            if let (Some((block, _)), Some(body)) = (rotary_ways.first(), self.unlevelled()) {
                low.push((*block, rotary_gap(body.name.clone())));
            }
            for TopWay { block, tool, length, way } in top_ways {
                let Some(info) = self.tool_of(*tool).map(|tool| tool.tool.info()) else { continue };
                // The tip of a tool of unknown length is at least as low as the tool is drawn.
                let below = length.unwrap_or(info.reach().high * info.unit.millimetres());
                let mut way = way.clone();
                way.levels.iter_mut().for_each(|level| level.height -= below);
                if let Some(name) = above(&below_tips, &way, LEVEL_ROUNDING) {
                    low.push((*block, JobGap::LowTop { name, tool: *tool }));
                }
            }
        }
        low
    }

    /// Returns the length of the shortest tool, in the part's unit: as it is stated, or else as it is drawn.
    fn shortest(&self) -> f64 {
        let program = self.program.readings().first();
        let lengths = self.tools.iter().map(|JobTool { tool, motions, .. }| {
            let stated = match motions {
                ToolSelection::All => None,
                ToolSelection::Number(number) => program.and_then(|p| p.tool_length(*number)),
            };
            let info = tool.info();
            stated.unwrap_or(info.reach().high * info.unit.millimetres())
        });
        lengths.reduce(f64::min).unwrap_or(0.0) / self.unit().millimetres()
    }

    /// Returns what a tool, or a body that moves with it, can meet. The tip is `below` the gauge point: bodies that hang lower need as much
    /// more distance.
    fn obstacles(&self, below: f64) -> Vec<Obstacle<'_>> {
        let machine = self.program.machine();
        // An allowance below 0 is a distance to keep.
        let allowances = self.tools.iter().flat_map(|tool| &tool.allow).chain(&self.allow);
        let part_margin = allowances.map(|(_, depth)| -depth).fold(0.0, f64::max);
        let margin_of = |body: &Body<'_>| match body.role {
            BodyRole::Part => part_margin,
            BodyRole::Fixture { margin } | BodyRole::Machine { margin, .. } => margin,
        };
        // A body of the tool's side by its lowest Z of the machine while all axes are at 0.
        let met = |link: Link, lowest: f64, distance: f64| match machine
            .is_none_or(|machine| is_carried(machine, link))
        {
            true => Met::Carried { margin: distance + (-lowest - below).max(0.0) },
            false => Met::Still { ceiling: lowest - distance },
        };
        let moves_with_tool = |link: Link| machine.is_some_and(|machine| is_of_tool(machine, link));
        let bodies = self.bodies.iter().enumerate().map(|(index, body)| {
            let corners = corners(body.bvh.bounds());
            let moving = self.revolved.iter().filter(|moving| moves_with_tool(moving.link));
            let moving = moving.filter(|moving| moving.against.contains(&index));
            // Of a pair the larger distance holds.
            let solids = moving.map(|moving| {
                let lowest =
                    self.hull(moving).iter().map(|point| point.z).fold(f64::INFINITY, f64::min);
                met(moving.link, lowest, moving.margin.max(margin_of(body)))
            });
            let tool = body.meets_tools().then(|| Met::Carried { margin: margin_of(body) });
            Obstacle {
                name: &body.name,
                link: machine.map(|machine| body.frame.link(machine)),
                hull: match body.frame {
                    BodyFrame::Machine(_) => Hull::Machine(corners),
                    BodyFrame::Part | BodyFrame::Table(_) => Hull::Part(corners),
                },
                is_fixture: matches!(body.role, BodyRole::Fixture { .. }),
                met: solids.chain(tool).collect(),
            }
        });
        // No tool is checked against a solid of revolution: the meshes that move with the tool are.
        let revolved = self.revolved.iter().filter(|moving| !moves_with_tool(moving.link));
        let revolved = revolved.filter_map(|moving| {
            let machine = machine?;
            let against = moving.against.iter().map(|index| &self.bodies[*index]);
            let meshes = against.map(|body| (body, body.frame.link(machine)));
            let meshes = meshes.filter(|(_, link)| moves_with_tool(*link)).map(|(body, link)| {
                met(link, body.bvh.bounds()[0].z, moving.margin.max(margin_of(body)))
            });
            Some(Obstacle {
                name: &moving.name,
                link: Some(moving.link),
                hull: Hull::Machine(self.hull(moving)),
                is_fixture: false,
                met: meshes.collect(),
            })
        });
        let stock = self.stock.as_ref().map(|stock| Obstacle {
            name: STOCK,
            link: machine.map(|machine| machine.last_link(Side::Table)),
            hull: Hull::Part(corners(JobStock::bounds(stock))),
            is_fixture: false,
            met: vec![Met::Carried { margin: 0.0 }],
        });
        let all = bodies.chain(revolved).chain(stock);
        all.filter(|obstacle| !obstacle.met.is_empty()).collect()
    }

    /// Returns points around a solid of revolution, in machine coordinates while all axes are at 0, in the part's unit.
    fn hull(&self, moving: &RevolvedBody<'_>) -> Vec<Point3<f64>> {
        let (info, scale) = (moving.shape.info(), 1.0 / self.unit().millimetres());
        let (reach, unit) = (info.reach(), info.unit.millimetres());
        let outer = info.radius() / (PI / f64::from(CIRCLE_POINTS)).cos();
        let mut points = Vec::new();
        for z in [reach.low, reach.high] {
            for point in 0..CIRCLE_POINTS {
                let (sine, cosine) = (TAU * f64::from(point) / f64::from(CIRCLE_POINTS)).sin_cos();
                let point = unit * Vector3::new(outer * cosine, outer * sine, z);
                let point = moving.mount.tip() + moving.mount.rotation() * point;
                points.push(scale * point);
            }
        }
        points
    }

    /// Returns a body of the machine that can meet another one, both of which the tool moves with or neither: its level says nothing of
    /// them.
    fn unlevelled(&self) -> Option<&RevolvedBody<'_>> {
        let machine = self.program.machine()?;
        self.revolved.iter().find(|moving| {
            let mut against = moving.against.iter().map(|index| self.bodies[*index].frame);
            against.any(|frame| {
                is_of_tool(machine, moving.link) == is_of_tool(machine, frame.link(machine))
            })
        })
    }

    /// Returns where obstacles stand on the machine, if there is one.
    fn setting(&self, reading: &MachineProgram) -> Option<Setting<'_>> {
        let machine = self.program.machine()?;
        let origin = reading.part_origin();
        let setup = Setup { work_offset: origin.unwrap_or_default(), tool_length: 0.0 };
        // At a length of 0 the tip is at the origin of machine coordinates while all axes are at 0.
        let pose = machine.chain(&setup).and_then(|chain| chain.pose(&[0.0; 6])).ok()?;
        let tip = pose.tip() / self.unit().millimetres();
        let part = Pose::from_computed(*pose.rotation(), tip);
        Some(Setting { machine, part, is_placed: origin.is_some() })
    }

    /// Returns the height of an obstacle above a way, with what has to be between; `None` for one that is not in it. What stands still on
    /// the machine is out of the way at the top of Z's travel, and what moves with the tool anywhere.
    fn height_above(
        &self,
        obstacle: &Obstacle<'_>,
        way: &BlindWay,
        setting: Option<&Setting<'_>>,
    ) -> Option<f64> {
        let heights = obstacle.met.iter().filter_map(|met| match met {
            Met::Carried { margin } => Some(self.height_over(obstacle, way, setting)? + margin),
            Met::Still { ceiling } => {
                let base = setting?.base_height(&way.levels, *ceiling) * self.unit().millimetres();
                let way = BlindWay { levels: at_height(&way.levels, base), is_at_top: false };
                self.height_over(obstacle, &way, setting)
            }
        });
        heights.reduce(f64::max)
    }

    /// Returns the height of an obstacle over the levels of a way.
    fn height_over(
        &self,
        obstacle: &Obstacle<'_>,
        way: &BlindWay,
        setting: Option<&Setting<'_>>,
    ) -> Option<f64> {
        let Obstacle { hull, is_fixture, .. } = obstacle;
        let (part, links) = way.levels.split_last()?;
        let unit = self.unit().millimetres();
        let (Some(setting), Some(link)) = (setting, obstacle.link) else {
            let Hull::Part(points) = hull else { return Some(f64::INFINITY) };
            return Some(top(points, &part.up) - part.height / unit);
        };
        let machine = setting.machine;
        let is_at_part = link == machine.last_link(Side::Table);
        let carriers: Vec<&Axis> =
            machine.axes().iter().filter(|axis| axis.side == Side::Table).collect();
        let index = match link {
            _ if is_at_part => links.len(),
            _ if link == machine.last_link(Side::Tool) => return None,
            Link::Base => 0,
            Link::Axis(letter) => match carriers.iter().position(|axis| axis.letter == letter) {
                Some(index) => index + 1,
                // X and Y of a head can be anywhere beside what another link of it carries.
                None if way.is_at_top => return None,
                None => return Some(f64::INFINITY),
            },
        };
        if way.is_at_top && index == 0 && !is_at_part && !is_fixture {
            return None;
        }
        let level = links.get(index).unwrap_or(part);
        if level.height > f64::NEG_INFINITY {
            let points = match index < links.len() {
                true => setting.on_machine(hull),
                false => setting.on_part(hull),
            };
            return Some(top(&points, &level.up) - level.height / unit);
        }
        // An obstacle that is tilted by unknown angles of its carriers is as high as it can swing.
        let Some(base) = way.levels.first().filter(|_| setting.is_placed) else {
            return Some(f64::INFINITY);
        };
        let points = setting.on_machine(hull);
        Some(swing(&carriers[..index], &points, unit) - base.height / unit)
    }
}

/// Returns the gap of rapid traverse of rotary axes, lower than something of a name.
fn rotary_gap(name: String) -> JobGap {
    JobGap::Motion(CheckGap::RotaryRapid { name })
}

/// Returns whether a link moves with the tool.
fn is_of_tool(machine: &Machine, link: Link) -> bool {
    match link {
        // A head without axes stands still.
        Link::Base => machine.last_link(Side::Tool) == Link::Base,
        Link::Axis(letter) => machine.axis(letter).is_some_and(|axis| axis.side == Side::Tool),
    }
}

/// Returns whether a link of the tool's side keeps its height to the spindle: Z of the head carries it, or the head has none.
fn is_carried(machine: &Machine, link: Link) -> bool {
    // The axes are in order from the base.
    let head = machine.axes().iter().filter(|axis| axis.side == Side::Tool);
    let place = |letter: Letter| head.clone().position(|axis| axis.letter == letter);
    let own = match link {
        Link::Base => None,
        Link::Axis(letter) => place(letter),
    };
    place(Letter::Z).is_none_or(|z| own.is_some_and(|own| own >= z))
}

/// Returns the levels of something at a height of the first of them, in mm, in place of those of the tip.
fn at_height(levels: &[Level], height: f64) -> Vec<Level> {
    let Some((base, links)) = levels.split_first() else { return Vec::new() };
    let links = links.iter().map(|level| {
        let rise = level.height - base.height;
        Level { height: if rise.is_finite() { height + rise } else { f64::NEG_INFINITY }, ..*level }
    });
    std::iter::once(Level { height, ..*base }).chain(links).collect()
}

/// Returns the corners of a box.
fn corners([low, high]: [Point3<f64>; 2]) -> Vec<Point3<f64>> {
    let corner = |index: usize| {
        Point3::from(Vector3::from_fn(|k, _| if index >> k & 1 == 0 { low[k] } else { high[k] }))
    };
    (0..8).map(corner).collect()
}

/// Returns the height of points along a direction.
fn top(points: &[Point3<f64>], up: &Vector3<f64>) -> f64 {
    points.iter().map(|point| point.coords.dot(up)).fold(f64::NEG_INFINITY, f64::max)
}

/// Returns an upper bound on Z of the machine that points reach at any angles of the rotary axes that carry them: exact for one axis.
/// `carriers` are in order from the base, `unit` is in mm.
fn swing(carriers: &[&Axis], points: &[Point3<f64>], unit: f64) -> f64 {
    let (rotary, linear): (Vec<&Axis>, Vec<&Axis>) =
        carriers.iter().partition(|axis| axis.letter.is_rotary());
    // Linear axes carry the rotary ones, and X and Y keep the height.
    if linear.iter().any(|axis| axis.direction.z != 0.0) {
        return f64::INFINITY;
    }
    let circles = points.iter().map(|point| match rotary[..] {
        [axis] => Circle::of(axis, point, unit).top(),
        [inner, outer] => {
            let Circle { centre, radius, axis } = Circle::of(outer, point, unit);
            let carried = Circle::of(inner, &centre, unit);
            // The point is at the centre and a vector v across the outer axis. Along the inner axis v is no longer than its projection, and
            // across it the square of the radius grows by that of v and twice its product with what of the arm is across the outer axis.
            let along = radius * axis.cross(&carried.axis).norm();
            let arm = centre - carried.centre;
            let across = (arm - axis * arm.dot(&axis)).norm();
            let squared = carried.radius.powi(2) + 2.0 * across * radius + radius.powi(2);
            Circle { radius: squared.sqrt(), ..carried }.top() + along * carried.axis.z.abs()
        }
        _ => f64::INFINITY,
    });
    circles.fold(f64::NEG_INFINITY, f64::max)
}

/// The circle of a point about a rotary axis.
struct Circle {
    centre: Point3<f64>,
    radius: f64,
    /// The direction of the axis, a unit vector.
    axis: Vector3<f64>,
}

impl Circle {
    /// Returns the circle of a point. `unit` is in mm.
    fn of(axis: &Axis, point: &Point3<f64>, unit: f64) -> Circle {
        let origin = axis.point / unit;
        let centre = origin + axis.direction * (point - origin).dot(&axis.direction);
        Circle { centre, radius: (point - centre).norm(), axis: axis.direction }
    }

    /// Returns its greatest Z.
    fn top(&self) -> f64 {
        self.centre.z + self.radius * (1.0 - self.axis.z.powi(2)).max(0.0).sqrt()
    }
}
