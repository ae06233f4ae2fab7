//! Random intents that fit the state of the control.

use super::meaning::{
    Align, Arc, Control, Drill, Intent, Language, PlaneForm, SwivelRetract, Tilt,
};
use crate::oracle::Random;
use nalgebra::Vector3;

impl Control {
    /// Returns a random length that the program can state exactly.
    fn length_between(&self, random: &mut Random, low: f64, high: f64) -> f64 {
        let grid = if self.unit == 1.0 { 0.01 } else { 0.254 };
        (random.between(low, high) / grid).round() * grid
    }

    fn angle_of(&self, random: &mut Random, axis: usize) -> f64 {
        let reach = if axis == 5 { 300.0 } else { 70.0 };
        if random.chance(0.3) { 0.0 } else { random.between(-reach, reach).round() }
    }

    fn line_to(&self, random: &mut Random, is_full: bool) -> Intent {
        let mut axes = [None; 6];
        let all = if is_full { 1.0 } else { 0.6 };
        let is_incremental = !is_full && random.chance(0.2);
        let mut incremental = [is_incremental; 6];
        for (k, to) in axes.iter_mut().enumerate().take(3) {
            if random.chance(all) {
                let [low, high] = if k == 2 { [5.0, 80.0] } else { [-50.0, 50.0] };
                *to = Some(self.length_between(random, low, high));
                if is_incremental {
                    *to = Some(self.length_between(random, -25.0, 25.0));
                }
            }
        }
        if !self.is_iso() && !is_full && random.chance(0.2) {
            let axis = random.choice(3);
            (axes[axis], incremental[axis]) =
                (Some(self.length_between(random, -20.0, 20.0)), true);
        }
        if !is_full && !self.is_aligned && !self.is_vector && random.chance(0.4) {
            for k in (3..6).filter(|k| self.machine.has(*k)) {
                if random.chance(0.6) {
                    axes[k] = Some(self.angle_of(random, k));
                    if incremental[k] {
                        axes[k] = Some(random.between(-20.0, 20.0).round());
                    }
                }
            }
        }
        if axes == [None; 6] {
            axes[0] = Some(self.length_between(random, -50.0, 50.0));
        }
        Intent::Line { axes, incremental, rapid: random.chance(0.4) }
    }

    fn arc(&self, random: &mut Random) -> Intent {
        // A radius and a centre of few digits.
        let radius = random.between(5.0, 30.0).round() * if self.unit == 1.0 { 1.0 } else { 1.27 };
        let [x, y] =
            [[0.6, 0.8], [0.8, -0.6], [-0.96, 0.28], [0.0, 1.0], [-0.28, -0.96]][random.choice(5)];
        let sweep = loop {
            let sweep = random.between(25.0, 330.0);
            if (sweep - 180.0f64).abs() > 20.0 {
                break sweep;
            }
        };
        let klartext = self.language == Language::Klartext;
        let form = random.choice(if klartext { 4 } else { 3 });
        let has_rise = random.chance(0.3) && !(klartext && form == 3);
        // Sinumerik counts the length of the tool across the plane.
        let is_flat = self.language == Language::Sinumerik || klartext && form == 3;
        let normal = if is_flat || random.chance(0.7) { 2 } else { random.choice(2) };
        let can_turn = match self.language {
            Language::LinuxCnc | Language::Sinumerik => form == 0,
            Language::Klartext => form == 1,
            _ => false,
        };
        let turns = if can_turn && random.chance(0.2) { 1 } else { 0 };
        let is_heading =
            !klartext && turns == 0 && self.machine.has(5) && !self.is_aligned && !self.is_vector;
        let heading =
            (is_heading && random.chance(0.15)).then(|| random.between(-90.0, 90.0).round());
        Intent::Arc(Arc {
            turns,
            heading,
            normal,
            centre: [radius * x, radius * y],
            sweep: if random.chance(0.5) { sweep } else { -sweep },
            rise: if has_rise && (!klartext || form < 2 || normal == 2) {
                self.length_between(random, -10.0, 10.0)
            } else {
                0.0
            },
            rapid: klartext && random.chance(0.4),
            form,
        })
    }

    fn shift_by(&self, random: &mut Random) -> Intent {
        let mut axes = [None; 6];
        for (k, by) in axes.iter_mut().enumerate() {
            if k < 3 && random.chance(0.6) {
                *by = Some(self.length_between(random, -15.0, 15.0));
            } else if k > 2 && self.machine.has(k) && !self.is_tilted && random.chance(0.3) {
                *by = Some(random.between(-30.0, 30.0).round());
            }
        }
        if axes == [None; 6] {
            axes[1] = Some(self.length_between(random, -15.0, 15.0));
        }
        Intent::Shift { axes, adds: !self.is_iso() && random.chance(0.4) }
    }

    fn plane(&self, random: &mut Random) -> Intent {
        let is_level = random.chance(0.15);
        let mut angles = [0; 3].map(|_| match is_level || random.chance(0.3) {
            true => 0.0,
            false => random.between(-50.0, 50.0).round(),
        });
        let klartext = self.language == Language::Klartext;
        if is_level && self.is_iso() && random.chance(0.5) {
            // A plane that keeps Z, without the alignment.
            let (form, retract) = (PlaneForm::Euler, SwivelRetract::None);
            let (before, after, align) = ([0.0; 3], [0.0; 3], Align::Rest);
            return Intent::Tilt(Tilt { before, angles, after, form, align, retract });
        }
        let form = match random.choice(4) {
            _ if self.language == Language::Sinumerik => {
                let [first, step] = [random.choice(3), 1 + random.choice(2)];
                let second = (first + step) % 3;
                PlaneForm::Axes { order: [first, second, 3 - first - second], adds: self.is_tilted }
            }
            _ if !klartext => PlaneForm::Euler,
            0 if self.is_tilted => PlaneForm::Relative(random.choice(3)),
            0 | 1 => PlaneForm::Vectors,
            2 => PlaneForm::Euler,
            _ => PlaneForm::Spatial,
        };
        if form == PlaneForm::Euler && !is_level {
            angles[0] = random.between(-180.0, 180.0).round();
        }
        let align = match random.choice(3) {
            1 if klartext => Align::Separately,
            2 if klartext => Align::About([0.0, 20.0][random.choice(2)]),
            _ => Align::Turn,
        };
        let mut point = || [0; 3].map(|_| self.length_between(random, -15.0, 15.0));
        let [mut before, mut after] = [point(), point()];
        let mut retract = SwivelRetract::None;
        if self.language == Language::Sinumerik {
            retract = match random.choice(7) {
                0 => SwivelRetract::Z,
                1 => SwivelRetract::All,
                2 if !self.is_tilted => {
                    SwivelRetract::Along(self.length_between(random, 5.0, 30.0))
                }
                _ => SwivelRetract::None,
            };
        } else {
            after = [0.0; 3];
            before = if klartext { after } else { before };
        }
        let again = self.last_plane.filter(|_| random.chance(0.3));
        Intent::Tilt(again.unwrap_or(Tilt { before, angles, after, form, align, retract }))
    }

    fn vector(&self, random: &mut Random) -> Intent {
        let place = [0; 3].map(|_| self.length_between(random, -40.0, 60.0));
        let axis = Vector3::z() + random.vector(0.6);
        Intent::Vector { place, axis: axis.normalize().into() }
    }

    fn holes(&self, random: &mut Random) -> Intent {
        let count = 1 + random.choice(3);
        let points = (0..count).map(|_| [0; 2].map(|_| self.length_between(random, -40.0, 40.0)));
        let points = points.collect();
        let top = self.length_between(random, 10.0, 40.0);
        let depth = self.length_between(random, 5.0, 20.0);
        let clear = top + self.length_between(random, 0.0, 30.0);
        let infeed = random.chance(0.5).then(|| self.length_between(random, 3.0, 8.0));
        let infeed = infeed.filter(|_| self.language != Language::Sinumerik);
        let (returns_to_top, form) = (random.chance(0.5), random.choice(3));
        Intent::Drill(Drill {
            points,
            top,
            bottom: top - depth,
            clear,
            infeed,
            returns_to_top,
            form,
        })
    }

    fn machine_place(&self, random: &mut Random) -> Intent {
        let mut axes = [None; 6];
        if self.machine.limits(5).is_some() && self.machine.has(5) && random.chance(0.3) {
            axes[5] = Some((self.joints[5] + random.between(-40.0, 40.0)).round());
        }
        for (k, to) in axes.iter_mut().enumerate().take(3) {
            if random.chance(0.5) {
                let at = self.joints[k] + random.between(-20.0, 20.0);
                *to = Some(self.length_between(random, at, at));
            }
        }
        axes[2] = axes[2].or((axes == [None; 6]).then_some(0.0));
        Intent::Machine { axes }
    }
}

/// Draws the next intent, and a position with all of X, Y and Z after most of those that change coordinates.
pub(crate) fn draw(random: &mut Random, control: &Control) -> Vec<Intent> {
    let is_rotated = control.inner.rotation.angle() > 0.0;
    let is_mirrored = control.mirror != Vector3::repeat(1.0);
    let is_plain = !control.is_tilted && !is_rotated && !is_mirrored;
    let (iso, klartext) = (control.is_iso(), control.language == Language::Klartext);
    let sinumerik = control.language == Language::Sinumerik;
    let linuxcnc = control.language == Language::LinuxCnc;
    let turns = control.machine.has(5);
    let can_align = control.machine.tilting.is_some();
    let has_inner = control.inner.translation.vector.norm() > 0.0;
    let is_shifted = control.shift != [0.0; 6];
    let can_frame = is_plain && (!sinumerik || !has_inner && !is_shifted);
    let can_plane = can_frame || !iso && control.is_tilted && !is_rotated && !has_inner;
    let can_shift = is_plain || sinumerik || klartext && control.is_tilted && !is_shifted;
    let can_rotate = !is_rotated && !is_mirrored && !linuxcnc && (is_plain || !iso);
    let has_turned_offset = (3..6).any(|k| {
        let [first, second] = control.origins.map(|origin| origin[k]);
        first != second || control.shift[k] != 0.0 || first != 0.0 && control.machine.is_of_table(k)
    });
    let whole = |random: &mut Random, reach: f64| random.between(-reach, reach).round();
    for _ in 0..100 {
        let intent = match random.choice(30) {
            0..8 => return vec![control.line_to(random, false)],
            8..11 if !control.is_vector => return vec![control.arc(random)],
            11 if is_plain => Intent::Offset(1 - control.offset),
            12 if can_shift && control.preset == [0.0; 6] => control.shift_by(random),
            13 if sinumerik && control.is_tcp => {
                Intent::Rotate { axis: random.choice(3), angle: whole(random, 60.0) }
            }
            13 if can_rotate && !control.is_tcp => {
                Intent::Rotate { axis: 2, angle: whole(random, 90.0) }
            }
            14..17 if can_align && can_plane && !control.is_tcp && !linuxcnc => {
                control.plane(random)
            }
            17 | 18 if is_rotated || control.is_tilted || sinumerik && !can_frame => {
                let align = [Some(Align::Turn), Some(Align::About(0.0)), None][random.choice(3)];
                Intent::Level(align.filter(|_| klartext && control.is_tilted))
            }
            19 | 20
                if turns
                    && can_frame
                    && (control.is_tcp
                        || random.chance(if has_turned_offset { 0.1 } else { 1.0 })) =>
            {
                let is_on = !control.is_tcp;
                let can_point = control.language == Language::Fanuc && can_align;
                Intent::Tcp { is_on, is_vector: is_on && can_point && random.chance(0.4) }
            }
            21 if !control.is_tcp => {
                let allowance = control.length_between(random, -2.0, 2.0);
                let has_allowance = klartext && random.chance(0.3);
                let allowance = if has_allowance { allowance } else { 0.0 };
                Intent::Change { tool: 1 - control.tool, allowance }
            }
            22 if !control.is_tcp && !klartext => match control.length {
                Some(length) if length == control.tool && random.chance(0.7) => continue,
                Some(length) if length == control.tool => Intent::Length(false),
                _ => Intent::Length(true),
            },
            23 if !control.is_tcp => control.holes(random),
            24 if !control.is_tcp && (is_plain || !iso) => match random.choice(3) {
                0 if klartext => Intent::Retract(control.length_between(random, 5.0, 40.0)),
                1 if iso => {
                    let height = control.length_between(random, 40.0, 90.0);
                    Intent::Home { via: [None, None, Some(height)] }
                }
                _ => control.machine_place(random),
            },
            25 | 26 if control.is_tcp && can_align && (control.is_vector || sinumerik) => {
                return vec![control.vector(random)];
            }
            28 if klartext && !control.is_tcp => {
                Intent::Retract(control.length_between(random, 5.0, 40.0))
            }
            29 if klartext && control.is_tilted && !is_shifted => control.shift_by(random),
            27 if linuxcnc && control.offset == 0 && random.chance(0.5) => {
                let [x, y, z, ..] = control.origins[1];
                let origin =
                    [x, y, z].map(|value| control.length_between(random, value, value + 9.0));
                let turn = if random.chance(0.5) { 0.0 } else { whole(random, 90.0) };
                Intent::Origin { origin, turn }
            }
            27 if linuxcnc && !is_shifted && !control.is_tcp => {
                let mut axes = [None; 6];
                axes[0] = Some(control.length_between(random, -30.0, 30.0));
                axes[2] = Some(control.length_between(random, 0.0, 60.0));
                Intent::Preset { axes }
            }
            27 if !control.is_tilted
                && !is_rotated
                && !sinumerik
                && !linuxcnc
                && !control.is_tcp =>
            {
                Intent::Mirror([random.chance(0.5), random.chance(0.5)])
            }
            _ => continue,
        };
        let has_position =
            matches!(intent, Intent::Retract(_) | Intent::Machine { .. } | Intent::Drill(_));
        let needs_length = match intent {
            Intent::Change { .. } => iso && random.chance(0.9),
            Intent::Tcp { is_on: false, .. } => iso && !linuxcnc,
            _ => false,
        };
        let mut intents = vec![intent];
        if needs_length {
            intents.push(Intent::Length(true));
        }
        let is_open = match intents[0] {
            Intent::Rotate { .. } | Intent::Level(_) | Intent::Tilt(_) | Intent::Tcp { .. } => {
                iso && !linuxcnc || matches!(intents[0], Intent::Rotate { .. } | Intent::Level(_))
            }
            _ => false,
        };
        if !has_position && random.chance(if is_open { 0.92 } else { 0.4 }) {
            intents.push(control.line_to(random, true));
        }
        return intents;
    }
    vec![control.line_to(random, true)]
}
