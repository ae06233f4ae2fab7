//! Random intents that fit the state of the control.

use super::meaning::{Align, Arc, Control, Drill, Intent, Language};
use crate::oracle::Random;

/// Returns one of the first `count` numbers.
fn choice(random: &mut Random, count: usize) -> usize {
    random.between(0.0, count as f64) as usize
}

fn chance(random: &mut Random, of: f64) -> bool {
    random.between(0.0, 1.0) < of
}

impl Control {
    /// Returns a random length that the program can state exactly.
    fn length_between(&self, random: &mut Random, low: f64, high: f64) -> f64 {
        let grid = if self.unit == 1.0 { 0.01 } else { 0.254 };
        (random.between(low, high) / grid).round() * grid
    }

    fn angle_of(&self, random: &mut Random, axis: usize) -> f64 {
        let reach = if axis == 5 { 300.0 } else { 70.0 };
        if chance(random, 0.3) { 0.0 } else { random.between(-reach, reach).round() }
    }

    fn line_to(&self, random: &mut Random, is_full: bool) -> Intent {
        let mut axes = [None; 6];
        let all = if is_full { 1.0 } else { 0.6 };
        let is_incremental = !is_full && chance(random, 0.2);
        let mut incremental = [is_incremental; 6];
        for k in 0..3 {
            if chance(random, all) {
                let [low, high] = if k == 2 { [5.0, 80.0] } else { [-50.0, 50.0] };
                axes[k] = Some(self.length_between(random, low, high));
                if is_incremental {
                    axes[k] = Some(self.length_between(random, -25.0, 25.0));
                }
            }
        }
        if !self.is_iso() && !is_full && chance(random, 0.2) {
            let axis = choice(random, 3);
            (axes[axis], incremental[axis]) =
                (Some(self.length_between(random, -20.0, 20.0)), true);
        }
        if !is_full && !self.is_aligned && chance(random, 0.4) {
            for k in (3..6).filter(|k| self.machine.has(*k)) {
                if chance(random, 0.6) {
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
        Intent::Line { axes, incremental, rapid: chance(random, 0.4) }
    }

    fn arc(&self, random: &mut Random) -> Intent {
        let radius = random.between(5.0, 30.0);
        let angle = random.between(0.0, 360.0).to_radians();
        let sweep = loop {
            let sweep = random.between(25.0, 330.0);
            if (sweep - 180.0f64).abs() > 20.0 {
                break sweep;
            }
        };
        let klartext = self.language == Language::Klartext;
        let form = choice(random, if klartext { 4 } else { 3 });
        let has_rise = chance(random, 0.3) && !(klartext && form == 3);
        let normal =
            if chance(random, 0.7) || klartext && form == 3 { 2 } else { choice(random, 2) };
        Intent::Arc(Arc {
            normal,
            centre: [radius * angle.cos(), radius * angle.sin()]
                .map(|c| self.length_between(random, c, c)),
            sweep: if chance(random, 0.5) { sweep } else { -sweep },
            rise: if has_rise { self.length_between(random, -10.0, 10.0) } else { 0.0 },
            rapid: klartext && chance(random, 0.4),
            form,
        })
    }

    fn shift_by(&self, random: &mut Random) -> Intent {
        let mut axes = [None; 6];
        for k in 0..6 {
            if k < 3 && chance(random, 0.6) {
                axes[k] = Some(self.length_between(random, -15.0, 15.0));
            } else if k > 2 && self.machine.has(k) && !self.is_tilted && chance(random, 0.3) {
                axes[k] = Some(random.between(-30.0, 30.0).round());
            }
        }
        if axes == [None; 6] {
            axes[1] = Some(self.length_between(random, -15.0, 15.0));
        }
        Intent::Shift { axes, adds: !self.is_iso() && chance(random, 0.4) }
    }

    fn plane(&self, random: &mut Random) -> Intent {
        let mut angles = [0; 3]
            .map(|_| if chance(random, 0.3) { 0.0 } else { random.between(-50.0, 50.0).round() });
        if self.is_iso() {
            angles[0] = random.between(-180.0, 180.0).round();
        }
        let klartext = self.language == Language::Klartext;
        let align = match choice(random, 3) {
            1 if klartext => Align::Separately,
            2 if klartext => Align::About([0.0, 20.0][choice(random, 2)]),
            _ => Align::Turn,
        };
        let origin = [0; 3].map(|_| self.length_between(random, -15.0, 15.0));
        Intent::Tilt { origin: if klartext { [0.0; 3] } else { origin }, angles, align }
    }

    fn holes(&self, random: &mut Random) -> Intent {
        let count = 1 + choice(random, 3);
        let points = (0..count).map(|_| [0; 2].map(|_| self.length_between(random, -40.0, 40.0)));
        let points = points.collect();
        let top = self.length_between(random, 10.0, 40.0);
        let depth = self.length_between(random, 5.0, 20.0);
        let clear = top + self.length_between(random, 0.0, 30.0);
        let infeed = chance(random, 0.5).then(|| self.length_between(random, 3.0, 8.0));
        let infeed = infeed.filter(|_| self.language != Language::Sinumerik);
        let (returns_to_top, form) = (chance(random, 0.5), choice(random, 3));
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
        for k in 0..3 {
            if chance(random, 0.5) {
                let at = self.joints[k] + random.between(-20.0, 20.0);
                axes[k] = Some(self.length_between(random, at, at));
            }
        }
        axes[2] = axes[2].or((axes == [None; 6]).then_some(0.0));
        Intent::Machine { axes }
    }
}

/// Draws the next intent, and a position with all of X, Y and Z after most of those that change coordinates.
pub(crate) fn draw(random: &mut Random, control: &Control) -> Vec<Intent> {
    let is_rotated = control.inner.rotation.angle() > 0.0;
    let is_plain = !control.is_tilted && !is_rotated;
    let (iso, klartext) = (control.is_iso(), control.language == Language::Klartext);
    let sinumerik = control.language == Language::Sinumerik;
    let turns = control.machine.tilting.is_some();
    let linuxcnc = control.language == Language::LinuxCnc;
    let is_plain_frame = is_plain && control.inner.translation.vector.norm() == 0.0;
    for _ in 0..100 {
        let intent = match choice(random, 24) {
            0..8 => return vec![control.line_to(random, false)],
            8..11 => return vec![control.arc(random)],
            11 if is_plain => Intent::Offset(1 - control.offset),
            12 if is_plain
                || sinumerik
                || klartext && control.is_tilted && control.shift == [0.0; 6] =>
            {
                control.shift_by(random)
            }
            13 if is_plain && !control.is_tcp && !linuxcnc => {
                Intent::Rotate(random.between(-90.0, 90.0).round())
            }
            14 | 15
                if turns
                    && is_plain
                    && !control.is_tcp
                    && !linuxcnc
                    && (!sinumerik || is_plain_frame) =>
            {
                control.plane(random)
            }
            16 | 17 if !is_plain => Intent::Level,
            18 | 19 if turns && is_plain && (!sinumerik || is_plain_frame) => {
                Intent::Tcp(!control.is_tcp)
            }
            20 if !control.is_tcp => Intent::Change(1 - control.tool),
            21 if !control.is_tcp && !klartext => match control.length {
                Some(length) if length == control.tool && chance(random, 0.7) => continue,
                Some(length) if length == control.tool => Intent::Length(false),
                _ => Intent::Length(true),
            },
            22 if !control.is_tcp => control.holes(random),
            23 if !control.is_tcp && (is_plain || !iso) => match choice(random, 3) {
                0 if klartext => Intent::Retract(control.length_between(random, 5.0, 40.0)),
                1 if iso => Intent::Home {
                    via: [None, None, Some(control.length_between(random, 40.0, 90.0))],
                },
                _ => control.machine_place(random),
            },
            _ => continue,
        };
        let mut intents = vec![intent];
        let is_open = match intents[0] {
            Intent::Change(_) if iso && chance(random, 0.9) => {
                intents.push(Intent::Length(true));
                true
            }
            Intent::Tcp(false) if iso && !linuxcnc => {
                intents.push(Intent::Length(true));
                true
            }
            Intent::Retract(_) | Intent::Machine { .. } | Intent::Drill(_) => false,
            _ => true,
        };
        if is_open && chance(random, 0.75) {
            intents.push(control.line_to(random, true));
        }
        return intents;
    }
    vec![control.line_to(random, true)]
}
