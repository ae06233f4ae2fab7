//! The meaning of a program: intents, and the motions of a machine that executes them.

use super::Axes;
use super::kinematics::{Machine, ToolPose, about};
use nalgebra::{Isometry3, Point3, Rotation3, Translation3, Vector3};

/// Samples of a motion.
const SAMPLES: usize = 120;
/// Lengths of the tools T1 and T2, in mm.
pub(crate) const LENGTHS: [f64; 2] = [60.0, 85.0];

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Language {
    LinuxCnc,
    Fanuc,
    Haas,
    Klartext,
    Sinumerik,
}

/// The way of a rotary axis without limits to an angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Way {
    Counts,
    Shortest,
    WithinTurn,
}

/// The purpose of a block or a few blocks. Lengths are in mm and program coordinates.
#[derive(Clone, Debug)]
pub(crate) enum Intent {
    Line {
        axes: [Option<f64>; 6],
        incremental: [bool; 6],
        rapid: bool,
    },
    Arc(Arc),
    Offset(usize),
    /// A datum shift, or one that is added to that before.
    Shift {
        axes: [Option<f64>; 6],
        adds: bool,
    },
    /// A rotation about an axis, 2 but under `TRAORI`, by degrees.
    Rotate {
        axis: usize,
        angle: f64,
    },
    Tilt(Tilt),
    /// Mirrored axes, X and Y.
    Mirror([bool; 2]),
    /// New coordinates of the present position.
    Preset {
        axes: [Option<f64>; 6],
    },
    /// The origin of the second work offset, and its rotation about z.
    Origin {
        origin: [f64; 3],
        turn: f64,
    },
    /// The end of rotations and tilted planes.
    Level(Option<Align>),
    Tcp {
        is_on: bool,
        is_vector: bool,
    },
    /// A place of the tip, and a direction of the tool.
    Vector {
        place: [f64; 3],
        axis: [f64; 3],
    },
    /// A tool, and an allowance on its length.
    Change {
        tool: usize,
        allowance: f64,
    },
    Length(bool),
    /// Machine coordinates.
    Machine {
        axes: [Option<f64>; 6],
    },
    /// A return of X, Y, Z to the reference position over a place.
    Home {
        via: [Option<f64>; 3],
    },
    Drill(Drill),
    /// A retract along the tool.
    Retract(f64),
}

/// An arc by its centre from the start, its sweep in degrees, and its rise along the normal.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Arc {
    pub(crate) normal: usize,
    pub(crate) centre: [f64; 2],
    pub(crate) sweep: f64,
    pub(crate) rise: f64,
    pub(crate) rapid: bool,
    /// The form in which it is written.
    pub(crate) form: usize,
    /// Whole turns beside the sweep.
    pub(crate) turns: usize,
    /// The angle of C at its end.
    pub(crate) heading: Option<f64>,
}

/// A tilted plane: a point about which it is rotated, three angles, its origin in the rotated plane.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tilt {
    pub(crate) before: [f64; 3],
    pub(crate) angles: [f64; 3],
    pub(crate) after: [f64; 3],
    pub(crate) form: PlaneForm,
    pub(crate) align: Align,
    pub(crate) retract: SwivelRetract,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum PlaneForm {
    /// About the fixed axes.
    Spatial,
    /// By a vector of x and the normal.
    Vectors,
    /// About z, the new x and the new z.
    Euler,
    /// About one more axis of the plane before.
    Relative(usize),
    /// About axes in an order, of a new plane or of one that is added.
    Axes { order: [usize; 3], adds: bool },
}

/// The retract of CYCLE800.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum SwivelRetract {
    None,
    Z,
    All,
    Along(f64),
}

/// The way of the rotary axes to a plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Align {
    /// They rest, and are not those of the plane.
    Rest,
    /// The other axes rest.
    Turn,
    /// A block of its own turns them.
    Separately,
    /// About a point below the tip.
    About(f64),
}

/// Holes.
#[derive(Clone, Debug)]
pub(crate) struct Drill {
    pub(crate) points: Vec<[f64; 2]>,
    /// The level from which the tool drills, the bottom, and the level above to which it returns in Klartext and Sinumerik.
    pub(crate) top: f64,
    pub(crate) bottom: f64,
    pub(crate) clear: f64,
    pub(crate) infeed: Option<f64>,
    /// Set for a return to `top` in ISO words.
    pub(crate) returns_to_top: bool,
    pub(crate) form: usize,
}

/// Poses of the tool relative to the part during a motion, and the line of its block.
pub(crate) struct Motion {
    pub(crate) line: usize,
    pub(crate) rapid: bool,
    pub(crate) poses: Vec<ToolPose>,
}

/// A control with its machine.
pub(crate) struct Control {
    pub(crate) language: Language,
    pub(crate) machine: Machine,
    pub(crate) joints: Axes,
    pub(crate) origins: [Axes; 2],
    pub(crate) offset: usize,
    /// The shift outside of a plane.
    pub(crate) shift: Axes,
    /// The tilted plane, and the frame in it.
    pub(crate) plane: Isometry3<f64>,
    pub(crate) inner: Isometry3<f64>,
    /// Signs of X and Y, and the shift of G92.
    pub(crate) mirror: Vector3<f64>,
    pub(crate) preset: Axes,
    /// Rotations of the work offsets about z, in degrees.
    pub(crate) turns: [f64; 2],
    pub(crate) is_tilted: bool,
    pub(crate) last_plane: Option<Tilt>,
    pub(crate) is_aligned: bool,
    pub(crate) is_tcp: bool,
    pub(crate) is_vector: bool,
    /// The allowance on the length of the tool (DL).
    pub(crate) allowance: f64,
    /// The tool in the spindle, and the one whose length is in force.
    pub(crate) tool: usize,
    pub(crate) length: Option<usize>,
    /// The origin by which coordinates of the tip are those of the part, if they are not those of the work offset.
    standing: Option<Axes>,
    pub(crate) takes_table_as_it_stands: bool,
    pub(crate) each_axis: bool,
    pub(crate) rates: Axes,
    pub(crate) way: Way,
    /// The direction of the last motion in program coordinates, while these hold.
    pub(crate) tangent: Option<Vector3<f64>>,
    pub(crate) motions: Vec<Motion>,
    pub(crate) text: String,
    /// The unit of the program's lengths, in mm.
    pub(crate) unit: f64,
    pub(crate) is_incremental: bool,
}

/// Returns the plane of an arc: its axes in order.
pub(crate) fn plane_axes(normal: usize) -> [usize; 2] {
    [(normal + 1) % 3, (normal + 2) % 3]
}

impl Control {
    pub(crate) fn new(
        language: Language,
        machine: Machine,
        origins: [Axes; 2],
        rates: Axes,
    ) -> Control {
        let mut control = Control {
            language,
            machine,
            joints: [0.0; 6],
            origins,
            offset: 0,
            shift: [0.0; 6],
            plane: Isometry3::identity(),
            inner: Isometry3::identity(),
            mirror: Vector3::repeat(1.0),
            preset: [0.0; 6],
            turns: [0.0; 2],
            is_vector: false,
            allowance: 0.0,
            is_tilted: false,
            last_plane: None,
            is_aligned: false,
            is_tcp: false,
            tool: 0,
            length: Some(0),
            standing: None,
            takes_table_as_it_stands: false,
            each_axis: matches!(language, Language::Fanuc | Language::Haas),
            rates,
            way: Way::Counts,
            tangent: None,
            motions: Vec::new(),
            text: String::new(),
            unit: 1.0,
            is_incremental: false,
        };
        control.joints = control.joints_at(&[0.0, 0.0, 100.0, 0.0, 0.0, 0.0]);
        control
    }

    pub(crate) fn is_iso(&self) -> bool {
        !matches!(self.language, Language::Klartext | Language::Sinumerik)
    }

    /// Returns whether coordinates are those of the tip on a table that turns.
    pub(crate) fn is_tip(&self) -> bool {
        self.is_tcp || self.is_aligned
    }

    fn length_in_force(&self) -> f64 {
        self.length.map_or(0.0, |tool| LENGTHS[tool] + self.allowance)
    }

    fn tip_frame(&self) -> Isometry3<f64> {
        let mut origin = self.origins[self.offset];
        if let Some(standing) = self.standing {
            origin[3..].copy_from_slice(&standing[3..]);
        }
        self.machine.part_frame(&origin)
    }

    /// Returns the shift outside of planes.
    fn whole_shift(&self) -> Axes {
        std::array::from_fn(|k| self.shift[k] + self.preset[k])
    }

    /// Returns the joints at program coordinates.
    pub(crate) fn joints_at(&self, position: &Axes) -> Axes {
        let (origin, shift) = (&self.origins[self.offset], self.whole_shift());
        let mut joints: Axes = std::array::from_fn(|k| position[k] + origin[k] + shift[k]);
        (3..6).filter(|k| !self.machine.has(*k)).for_each(|k| joints[k] = 0.0);
        let place = Vector3::new(position[0], position[1], position[2]);
        let place = Point3::from(place.component_mul(&self.mirror));
        let place =
            (self.plane * self.inner * place).coords + Vector3::new(shift[0], shift[1], shift[2]);
        if self.is_tip() {
            return self.machine.reach(&joints, place, self.length_in_force(), &self.tip_frame());
        }
        let place = about(2, self.turns[self.offset]) * place;
        (0..3).for_each(|k| joints[k] = place[k] + origin[k]);
        joints[2] += self.length_in_force();
        joints
    }

    /// Returns the program coordinates of the machine as it stands.
    pub(crate) fn position(&self) -> Axes {
        let (origin, shift) = (&self.origins[self.offset], self.whole_shift());
        let mut position: Axes = std::array::from_fn(|k| self.joints[k] - origin[k] - shift[k]);
        let place = match self.is_tip() {
            true => self.machine.pose(&self.joints, self.length_in_force(), &self.tip_frame()).tip,
            false => {
                let [x, y, z] = [0, 1, 2].map(|k| self.joints[k] - origin[k]);
                about(2, -self.turns[self.offset]) * Vector3::new(x, y, z - self.length_in_force())
            }
        };
        let place = Point3::from(place - Vector3::new(shift[0], shift[1], shift[2]));
        let place =
            ((self.plane * self.inner).inverse() * place).coords.component_mul(&self.mirror);
        position[..3].copy_from_slice(place.as_slice());
        position
    }

    /// Returns the pose of the tool in the spindle relative to the part, which stands at the first work offset.
    fn pose(&self, joints: &Axes) -> ToolPose {
        let part = self.machine.part_frame(&self.origins[0]);
        self.machine.pose(joints, LENGTHS[self.tool], &part)
    }

    fn line_number(&self) -> usize {
        self.text.lines().count()
    }

    /// Moves the joints on a path over time from 0 to 1.
    fn follow(&mut self, rapid: bool, path: impl Fn(&Control, f64) -> Axes) {
        let at = |k: usize| path(self, k as f64 / SAMPLES as f64);
        let joints: Vec<Axes> = (0..=SAMPLES).map(at).collect();
        let poses = joints.iter().map(|joints| self.pose(joints)).collect();
        self.joints = joints[SAMPLES];
        self.motions.push(Motion { line: self.line_number(), rapid, poses });
    }

    /// Comes to the first position from where the first tool change has left the axes, as far as that is known.
    pub(crate) fn approach(&mut self) {
        let (end, [x, y, z, ..]) = (self.joints, self.machine.change);
        if let (Some(x), Some(y), Some(z)) = (x, y, z) {
            (self.joints[0], self.joints[1], self.joints[2]) = (x, y, z);
            self.traverse([end[0], end[1], z, end[3], end[4], end[5]]);
        }
        self.joints[2] = z.unwrap_or(end[2]);
        self.traverse(end);
    }

    /// Lets a tool rest where it is.
    fn rest(&mut self) {
        let poses = vec![self.pose(&self.joints)];
        self.motions.push(Motion { line: self.line_number(), rapid: true, poses });
    }

    /// Moves the joints in rapid traverse: on a straight line, or each by itself.
    fn traverse(&mut self, end: Axes) {
        let start = self.joints;
        let durations: [f64; 6] = std::array::from_fn(|k| match self.each_axis {
            true => (end[k] - start[k]).abs() / self.rates[k],
            false => 1.0,
        });
        let longest = durations.iter().copied().fold(1e-9, f64::max);
        self.follow(true, |_, time| {
            std::array::from_fn(|k| {
                let share =
                    if durations[k] > 0.0 { (time * longest / durations[k]).min(1.0) } else { 1.0 };
                start[k] + share * (end[k] - start[k])
            })
        });
    }

    /// Moves to program coordinates, of which the rotary ones may begin at another turn.
    fn move_to(&mut self, start: Axes, end: Axes, rapid: bool) {
        let ends = [start, end];
        let linear = Vector3::from([0, 1, 2].map(|k| end[k] - start[k]));
        if linear.norm() > 1e-9 {
            self.tangent = Some(linear.normalize());
        }
        if rapid && !self.is_tcp {
            self.joints = self.joints_at(&start);
            return self.traverse(self.joints_at(&end));
        }
        self.follow(rapid, |control, time| {
            control
                .joints_at(&std::array::from_fn(|k| ends[0][k] + time * (ends[1][k] - ends[0][k])))
        });
    }

    /// Moves some coordinates.
    fn go(&mut self, axes: &[(usize, f64)], rapid: bool) {
        let start = self.position();
        let mut end = start;
        axes.iter().for_each(|(axis, value)| end[*axis] = *value);
        self.move_to(start, end, rapid);
    }

    fn line(&mut self, axes: &[Option<f64>; 6], incremental: &[bool; 6], rapid: bool) {
        let mut start = self.position();
        let mut end = start;
        for k in 0..6 {
            let Some(value) = axes[k] else { continue };
            end[k] = if incremental[k] { start[k] + value } else { value };
            if k == 5 && !incremental[k] {
                start = self.turned(start, Some(value));
            }
        }
        self.move_to(start, end, rapid);
    }

    /// Counts C of a start so that its way to an angle is that of the control.
    fn turned(&self, mut start: Axes, angle: Option<f64>) -> Axes {
        if let Some(end) = angle.filter(|_| self.machine.is_endless) {
            start[5] = end
                - match self.way {
                    Way::Counts => end - start[5],
                    Way::Shortest => (end - start[5] + 180.0).rem_euclid(360.0) - 180.0,
                    Way::WithinTurn => end.rem_euclid(360.0) - start[5].rem_euclid(360.0),
                };
        }
        start
    }

    /// Returns the arc with the centre that follows from the direction before, if it is tangent.
    pub(crate) fn resolved(&self, arc: &Arc) -> Arc {
        let is_tangent = self.language == Language::Klartext && arc.form == 3;
        let direction = self.tangent.filter(|_| is_tangent);
        let [u, v] = plane_axes(arc.normal);
        let Some(direction) = direction.filter(|d| d[u].hypot(d[v]) > 0.2) else {
            return Arc { form: if is_tangent { 0 } else { arc.form }, ..*arc };
        };
        let radius = arc.centre[0].hypot(arc.centre[1]) * arc.sweep.signum();
        let length = direction[u].hypot(direction[v]);
        let centre = [-direction[v] / length * radius, direction[u] / length * radius];
        let sweep = arc.sweep.signum() * arc.sweep.abs().min(300.0);
        Arc { centre, sweep, rise: 0.0, turns: 0, ..*arc }
    }

    /// Returns program coordinates on an arc.
    pub(crate) fn on_arc(start: &Axes, arc: &Arc, time: f64) -> Axes {
        let [u, v] = plane_axes(arc.normal);
        let whole = 360.0 * arc.turns as f64 * arc.sweep.signum();
        let (sine, cosine) = (time * (arc.sweep + whole)).to_radians().sin_cos();
        let [x, y] = arc.centre;
        let mut at = *start;
        if let Some(heading) = arc.heading {
            at[5] += time * (heading - start[5]);
        }
        at[u] += x - x * cosine + y * sine;
        at[v] += y - y * cosine - x * sine;
        at[arc.normal] += time * arc.rise;
        at
    }

    fn drill(&mut self, drill: &Drill) {
        let initial = self.position()[2];
        let Drill { top, bottom, infeed, .. } = *drill;
        if self.language == Language::LinuxCnc && initial < top {
            self.go(&[(2, top)], true);
        }
        let back = match self.language {
            Language::Klartext | Language::Sinumerik => drill.clear,
            Language::LinuxCnc if !drill.returns_to_top => initial.max(top),
            _ if !drill.returns_to_top => initial,
            _ => top,
        };
        for [x, y] in &drill.points {
            self.go(&[(0, *x), (1, *y)], true);
            self.go(&[(2, top)], true);
            // Klartext counts infeeds from the surface, which is 2 mm below.
            let surface = if self.language == Language::Klartext { top - 2.0 } else { top };
            let mut level = surface;
            while let Some(infeed) = infeed
                && level - infeed > bottom + 1e-9
            {
                level -= infeed;
                self.go(&[(2, level)], false);
                self.go(&[(2, top)], true);
                self.go(&[(2, level)], true);
            }
            self.go(&[(2, bottom)], false);
            self.go(&[(2, back)], true);
        }
    }

    /// Executes an intent, whose text has been written.
    pub(crate) fn execute(&mut self, intent: &Intent) {
        if !matches!(intent, Intent::Line { .. } | Intent::Arc(_)) {
            self.tangent = None;
        }
        match intent {
            Intent::Line { axes, incremental, rapid } => self.line(axes, incremental, *rapid),
            Intent::Arc(arc) => {
                let (start, arc) = (self.position(), self.resolved(arc));
                let start = self.turned(start, arc.heading);
                self.follow(arc.rapid, |control, time| {
                    control.joints_at(&Control::on_arc(&start, &arc, time))
                });
                let ahead = [0.999, 1.0].map(|time| Control::on_arc(&start, &arc, time));
                let direction = [0, 1, 2].map(|k| ahead[1][k] - ahead[0][k]);
                self.tangent = Some(Vector3::from(direction).normalize());
            }
            Intent::Offset(offset) => {
                self.offset = *offset;
                // Another preset ends the shift, mirrored axes and the rotation.
                if self.language == Language::Klartext {
                    (self.shift, self.inner) = ([0.0; 6], Isometry3::identity());
                    self.mirror = Vector3::repeat(1.0);
                }
            }
            Intent::Shift { axes, adds } => self.set_shift(axes, *adds),
            Intent::Rotate { axis, angle } => {
                let turn =
                    Isometry3::from_parts(Translation3::identity(), about(*axis, *angle).into());
                self.inner = match self.language {
                    Language::Sinumerik => self.inner * turn,
                    _ => self.inner.translation * turn,
                };
            }
            Intent::Tilt(tilt) => self.tilt(tilt),
            Intent::Mirror(mirrored) => {
                (0..2).for_each(|k| self.mirror[k] = if mirrored[k] { -1.0 } else { 1.0 });
            }
            Intent::Preset { axes } => {
                let position = self.position();
                for k in 0..6 {
                    self.preset[k] += axes[k].map_or(0.0, |value| position[k] - value);
                }
            }
            Intent::Origin { origin, turn } => {
                self.origins[1][..3].copy_from_slice(origin);
                self.turns[1] = *turn;
            }
            Intent::Level(align) => {
                if self.language == Language::Sinumerik {
                    self.shift[3..].fill(0.0);
                }
                (self.plane, self.inner) = (Isometry3::identity(), Isometry3::identity());
                (self.is_tilted, self.is_aligned, self.standing) = (false, false, None);
                if let Some(align) = align {
                    let mut end = self.position();
                    end[3..].fill(0.0);
                    let end = self.joints_at(&end);
                    self.turn_to(end, *align);
                }
            }
            Intent::Tcp { is_on, is_vector } => {
                (self.is_tcp, self.is_vector) = (*is_on, *is_vector);
                self.stand(*is_on);
                if self.is_iso() && self.language != Language::LinuxCnc {
                    self.length = is_on.then_some(self.tool);
                }
            }
            Intent::Vector { place, axis } => {
                let start = self.position();
                let direction = self.plane * self.inner * Vector3::from(*axis);
                let along = self.tip_frame() * direction;
                let aligned = self.machine.align(&self.joints, along, false);
                let aligned = aligned.unwrap_or(self.joints);
                let mut end = start;
                end[..3].copy_from_slice(place);
                for k in 3..6 {
                    end[k] += aligned[k] - self.joints[k];
                }
                self.move_to(start, end, false);
            }
            Intent::Change { tool, allowance } => {
                (self.tool, self.allowance) = (*tool, *allowance);
                if !self.is_iso() {
                    self.length = Some(*tool);
                }
                for (joint, change) in self.joints.iter_mut().zip(self.machine.change) {
                    *joint = change.unwrap_or(*joint);
                }
                self.rest();
            }
            Intent::Length(is_on) => self.length = is_on.then_some(self.tool),
            Intent::Machine { axes } => {
                let mut end: Axes = std::array::from_fn(|k| axes[k].unwrap_or(self.joints[k]));
                if self.language == Language::Sinumerik && axes[2].is_some() {
                    end[2] += self.length_in_force();
                }
                self.traverse(end);
            }
            Intent::Home { via } => {
                let places: Vec<(usize, f64)> = (0..3).filter_map(|k| Some((k, via[k]?))).collect();
                self.go(&places, true);
                let mut end = self.joints;
                places.iter().for_each(|(axis, _)| end[*axis] = 0.0);
                self.traverse(end);
            }
            Intent::Drill(drill) => self.drill(drill),
            Intent::Retract(distance) => self.retract(*distance),
        }
    }

    /// Moves along the tool.
    fn retract(&mut self, distance: f64) {
        let part = self.machine.part_frame(&self.origins[0]);
        let (start, length) = (self.joints, LENGTHS[self.tool]);
        let pose = self.pose(&start);
        self.follow(true, |control, time| {
            let tip = pose.tip + time * distance * pose.axis;
            control.machine.reach(&start, tip, length, &part)
        });
    }

    /// Turns the rotary axes to those of some joints.
    fn turn_to(&mut self, end: Axes, align: Align) {
        let start = self.joints;
        let Align::About(distance) = align else {
            return self.traverse([start[0], start[1], start[2], end[3], end[4], end[5]]);
        };
        let part = self.machine.part_frame(&self.origins[0]);
        let (pose, length) = (self.pose(&start), LENGTHS[self.tool]);
        let fixed = pose.tip - distance * pose.axis;
        self.follow(true, |control, time| {
            let mut joints = start;
            (3..6).for_each(|k| joints[k] += time * (end[k] - start[k]));
            let axis = control.machine.pose(&joints, length, &part).axis;
            control.machine.reach(&joints, fixed + distance * axis, length, &part)
        });
    }

    /// Fixes coordinates of the tip to the table as it stands, on controls that do so.
    fn stand(&mut self, is_on: bool) {
        self.standing = (is_on && self.takes_table_as_it_stands).then_some(self.joints);
    }

    fn set_shift(&mut self, axes: &[Option<f64>; 6], adds: bool) {
        let mut shift = self.shift;
        if self.language != Language::Sinumerik {
            let inside = self.inner.translation.vector;
            for k in 0..6 {
                let before = if self.is_tilted && k < 3 { inside[k] } else { shift[k] };
                shift[k] =
                    axes[k].map_or(before, |value| if adds { before + value } else { value });
            }
            if self.is_tilted {
                // Along the axes of the plane.
                self.inner.translation.vector = Vector3::new(shift[0], shift[1], shift[2]);
            } else {
                self.shift = shift;
            }
            return;
        }
        let by = Vector3::from([0, 1, 2].map(|k| axes[k].unwrap_or(0.0)));
        let before = if adds { self.inner } else { Isometry3::identity() };
        self.inner = before * Translation3::from(by);
        for k in 3..6 {
            let before = if adds { shift[k] } else { 0.0 };
            self.shift[k] = before + axes[k].unwrap_or(0.0);
        }
    }

    /// Returns the rotation of a plane.
    pub(crate) fn rotation_of(&self, tilt: &Tilt) -> Rotation3<f64> {
        let [first, second, third] = tilt.angles;
        match tilt.form {
            PlaneForm::Spatial | PlaneForm::Vectors => {
                about(2, third) * about(1, second) * about(0, first)
            }
            PlaneForm::Euler => about(2, first) * about(0, second) * about(2, third),
            PlaneForm::Relative(axis) => {
                self.plane.rotation.to_rotation_matrix() * about(axis, first)
            }
            PlaneForm::Axes { order, .. } => {
                about(order[0], first) * about(order[1], second) * about(order[2], third)
            }
        }
    }

    fn tilt(&mut self, tilt: &Tilt) {
        let mut end = self.joints;
        match tilt.retract {
            SwivelRetract::None => {}
            SwivelRetract::Along(distance) => self.retract(distance),
            SwivelRetract::Z | SwivelRetract::All => {
                end[2] = 0.0;
                self.traverse(end);
                if tilt.retract == SwivelRetract::All {
                    (end[0], end[1]) = (0.0, 0.0);
                    self.traverse(end);
                }
            }
        }
        let rotation = self.rotation_of(tilt);
        let place = |at: [f64; 3]| Translation3::from(Vector3::from(at));
        let turn = Isometry3::from_parts(Translation3::identity(), rotation.into());
        let plane = place(tilt.before) * turn * place(tilt.after);
        let is_added = matches!(tilt.form, PlaneForm::Axes { adds: true, .. });
        self.plane = if is_added { self.plane * plane } else { plane };
        self.inner = Isometry3::identity();
        if self.language == Language::Sinumerik {
            self.shift[3..].fill(0.0);
        }
        (self.is_tilted, self.is_aligned, self.last_plane) = (true, false, Some(*tilt));
        self.stand(true);
        if tilt.align == Align::Rest {
            return;
        }
        let along = self.tip_frame() * (self.plane * Vector3::z());
        // The direction of CYCLE800 is that of the lower value.
        let is_lower = self.language == Language::Sinumerik;
        if let Some(end) = self.machine.align(&self.joints, along, is_lower) {
            self.turn_to(end, tilt.align);
        }
        self.is_aligned = true;
    }
}
