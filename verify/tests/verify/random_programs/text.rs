//! Intents as blocks of a program.

use super::kinematics::LETTERS;
use super::meaning::{
    Align, Arc, Control, Drill, Intent, Language, PlaneForm, SwivelRetract, Tilt, Way, plane_axes,
};
use nalgebra::Vector3;
use std::fmt::Write;

impl Control {
    fn add(&mut self, line: impl AsRef<str>) {
        self.text.push_str(line.as_ref());
        self.text.push('\n');
    }

    /// Returns a number of a length in the unit of the program, to its least increment, or of an angle.
    fn number(&self, axis: usize, value: f64) -> String {
        let value = if axis < 3 { value / self.unit } else { value };
        let digits = if self.unit == 1.0 { 3 } else { 4 };
        match self.language {
            Language::Klartext => format!("{value:+.digits$}"),
            _ => format!("{value:.digits$}"),
        }
    }

    fn length(&self, value: f64) -> String {
        self.number(0, value)
    }

    fn words(&self, axes: &[Option<f64>]) -> String {
        let mut text = String::new();
        for (k, value) in axes.iter().enumerate() {
            if let Some(value) = value.filter(|_| k < 3 || self.machine.has(k)) {
                let _ = write!(text, " {}{}", LETTERS[k], self.number(k, value));
            }
        }
        text
    }

    /// Writes the head of the program, by which the tool comes to its first position.
    pub(crate) fn write_head(&mut self) {
        let rotary = self.words(&[None, None, None, Some(0.0), Some(0.0), Some(0.0)]);
        let (place, height) =
            (self.words(&[Some(0.0), Some(0.0)]), self.words(&[None, None, Some(100.0)]));
        let is_inch = self.unit != 1.0;
        match self.language {
            Language::Klartext => {
                self.add(format!("BEGIN PGM A {}", if is_inch { "INCH" } else { "MM" }));
                self.add("CYCL DEF 247 Q339=+1\nTOOL CALL 1 Z S1000");
                let shorter = if self.way == Way::Shortest { " M126" } else { "" };
                self.add(format!("L{rotary} R0 FMAX M3{shorter}"));
                self.add(format!("L{place} R0 FMAX"));
                self.add(format!("L{height} R0 FMAX"));
                return;
            }
            Language::Sinumerik => {
                self.add(format!("G17 G90 G54 G7{} G94 F500", if is_inch { "00" } else { "10" }));
                self.add("T1 M6\nD1\nS1000 M3\nORIMKS ORIAXES");
            }
            _ => {
                self.add(format!(
                    "G2{} G90 G17 G94 G54 G40 G80 G49 G69 F500.",
                    if is_inch { 0 } else { 1 }
                ));
                if self.language == Language::LinuxCnc {
                    self.text = self.text.replace(" G69", "");
                }
                self.add("T1 M6\nS1000 M3");
            }
        }
        let length = if self.is_iso() { "G43 H1" } else { "G0" };
        if !rotary.is_empty() {
            self.add(format!("G0{rotary}"));
        }
        self.add(format!("G0{place}"));
        self.add(format!("{length}{height}"));
    }

    pub(crate) fn write_end(&mut self) {
        self.distances(false);
        self.add("M30");
        if self.language == Language::Klartext {
            self.add("END PGM A MM");
        }
    }

    /// States absolute positions or increments.
    fn distances(&mut self, is_incremental: bool) {
        if self.language != Language::Klartext && self.is_incremental != is_incremental {
            self.add(if is_incremental { "G91" } else { "G90" });
            self.is_incremental = is_incremental;
        }
    }

    /// Writes the blocks of an intent at the present position.
    pub(crate) fn write(&mut self, intent: &Intent) {
        if !matches!(intent, Intent::Line { .. }) {
            self.distances(false);
        }
        match (self.language, intent) {
            (_, Intent::Line { axes, incremental, rapid }) => {
                self.write_line(axes, incremental, *rapid);
            }
            (_, Intent::Arc(arc)) => self.write_arc(&self.resolved(arc)),
            (_, Intent::Drill(drill)) => self.write_drill(drill),
            (Language::Klartext, intent) => self.write_klartext(intent),
            (Language::Sinumerik, intent) => self.write_sinumerik(intent),
            (_, intent) => self.write_iso(intent),
        }
    }

    fn write_line(&mut self, axes: &[Option<f64>; 6], incremental: &[bool; 6], rapid: bool) {
        let mut words = String::new();
        let is_incremental = incremental.iter().all(|is_incremental| *is_incremental);
        for k in 0..6 {
            let Some(value) = axes[k].filter(|_| k < 3 || self.machine.has(k)) else { continue };
            let (letter, number) = (LETTERS[k], self.number(k, value));
            let _ = match (self.language, incremental[k]) {
                (Language::Klartext, true) => write!(words, " I{letter}{number}"),
                (Language::Sinumerik, true) if !is_incremental => {
                    write!(words, " {letter}=IC({number})")
                }
                _ => write!(words, " {letter}{number}"),
            };
        }
        self.distances(is_incremental);
        let feed = if rapid { "FMAX" } else { "F500" };
        match self.language {
            Language::Klartext => self.add(format!("L{words} R0 {feed}")),
            _ => self.add(format!("G{}{words}", if rapid { 0 } else { 1 })),
        }
    }

    fn write_arc(&mut self, arc: &Arc) {
        let start = self.position();
        let end = Control::on_arc(&start, arc, 1.0);
        let [u, v] = plane_axes(arc.normal);
        let mut axes = [None; 6];
        (axes[u], axes[v]) = (Some(end[u]), Some(end[v]));
        if arc.rise != 0.0 {
            axes[arc.normal] = Some(end[arc.normal]);
        }
        axes[5] = arc.heading;
        let end = self.words(&axes);
        let radius = arc.centre[0].hypot(arc.centre[1]);
        let radius = self.length(if arc.sweep.abs() > 180.0 { -radius } else { radius });
        let pole = [(u, start[u] + arc.centre[0]), (v, start[v] + arc.centre[1])];
        if self.language == Language::Klartext {
            let sense = if arc.sweep > 0.0 { "DR+" } else { "DR-" };
            let feed = if arc.rapid { "FMAX" } else { "F500" };
            if arc.form < 2 {
                let mut at = [None; 3];
                pole.iter().for_each(|(axis, value)| at[*axis] = Some(*value));
                self.add(format!("CC{}", self.words(&at)));
            }
            let rise = match arc.rise {
                0.0 => String::new(),
                rise => format!(" I{}{}", LETTERS[arc.normal], self.length(rise)),
            };
            let sweep = arc.sweep + 360.0 * arc.turns as f64 * arc.sweep.signum();
            self.add(match arc.form {
                0 => format!("C{end} {sense} R0 {feed}"),
                1 => format!("CP IPA{sweep:+.5}{rise} {sense} R0 {feed}"),
                2 => format!("CR{end} R{radius} {sense} R0 {feed}"),
                _ => format!("CT{end} R0 {feed}"),
            });
            return;
        }
        if arc.normal != 2 {
            self.add(["G19", "G18"][arc.normal]);
        }
        let word = if arc.sweep > 0.0 { "G3" } else { "G2" };
        let letters = ["I", "J", "K"];
        let from_start = [(u, arc.centre[0]), (v, arc.centre[1])];
        let from_start =
            from_start.map(|(k, c)| format!(" {}{}", letters[k], self.length(c))).concat();
        let absolute = |before: &str, after: &str| {
            pole.map(|(k, c)| format!(" {}{before}{}{after}", letters[k], self.length(c))).concat()
        };
        let turns = match (self.language, arc.turns) {
            (_, 0) => String::new(),
            (Language::LinuxCnc, turns) => format!(" P{}", turns + 1),
            (_, turns) => format!(" TURN={turns}"),
        };
        self.add(match (self.language, arc.form) {
            (Language::Sinumerik, 1) => format!("{word}{end} CR={radius}"),
            (Language::Sinumerik, 2) => format!("{word}{end}{}", absolute("=AC(", ")")),
            (Language::LinuxCnc, 2) => format!("G90.1 {word}{end}{}\nG91.1", absolute("", "")),
            (_, 1) => format!("{word}{end} R{radius}"),
            _ => format!("{word}{end}{from_start}{turns}"),
        });
        if arc.normal != 2 {
            self.add("G17");
        }
    }

    fn write_drill(&mut self, drill: &Drill) {
        let [top, bottom, clear] =
            [drill.top, drill.bottom, drill.clear].map(|value| self.length(value));
        let points: Vec<String> =
            drill.points.iter().map(|[x, y]| self.words(&[Some(*x), Some(*y)])).collect();
        match self.language {
            Language::Klartext => {
                let number = if drill.infeed.is_some() { 200 } else { [200, 240, 201][drill.form] };
                let infeed = drill.infeed.unwrap_or(1000.0);
                let mut lines = vec![
                    format!("CYCL DEF {number} HOLE"),
                    format!(" Q200={}", self.length(2.0)),
                    format!(" Q201={}", self.length(drill.bottom - drill.top + 2.0)),
                    " Q206=+150".to_owned(),
                    format!(" Q203={}", self.length(drill.top - 2.0)),
                    format!(" Q204={}", self.length(drill.clear - drill.top + 2.0)),
                    " Q211=+0".to_owned(),
                ];
                match number {
                    200 => lines
                        .extend([format!(" Q202={}", self.length(infeed)), " Q210=+0".to_owned()]),
                    201 => lines.push(" Q208=+99999".to_owned()),
                    _ => lines.push(" Q343=+0".to_owned()),
                }
                self.add(lines.join(" ~\n"));
                for (k, point) in points.iter().enumerate() {
                    match (k + drill.form) % 2 {
                        0 => self.add(format!("L{point} R0 FMAX M99")),
                        _ => self.add(format!("L{point} R0 FMAX\nCYCL CALL")),
                    }
                }
            }
            Language::Sinumerik => {
                self.add(match drill.infeed {
                    None => format!("MCALL CYCLE81({clear},{top},0,{bottom})"),
                    Some(_) => format!("MCALL CYCLE82({clear},{top},0,{bottom},,0.1)"),
                });
                points.iter().for_each(|point| self.add(format!("G0{point}")));
                self.add("MCALL");
            }
            _ => {
                let level = if drill.returns_to_top { "G99" } else { "G98" };
                let first = points.first().expect("a hole");
                let head = format!("{first} Z{bottom} R{top}");
                self.add(match drill.infeed {
                    Some(infeed) => format!("{level} G83{head} Q{}", self.length(infeed)),
                    None => format!("{level} G81{head}"),
                });
                points[1..].iter().for_each(|point| self.add(point.trim()));
                self.add("G80 G98");
            }
        }
    }

    fn write_iso(&mut self, intent: &Intent) {
        let tool = self.tool + 1;
        match intent {
            Intent::Offset(offset) => self.add(["G54", "G55"][*offset]),
            Intent::Shift { axes, .. } => self.add(format!("G52{}", self.words(axes))),
            Intent::Rotate { angle, .. } => {
                self.add(format!("G0\nG68{} R{angle:.5}", self.words(&[Some(0.0), Some(0.0)])));
            }
            Intent::Tilt(Tilt { before, angles: [i, j, k], align, .. }) => {
                let origin = self.words(&before.map(Some));
                self.add(format!("G68.2{origin} I{i:.5} J{j:.5} K{k:.5}"));
                if *align != Align::Rest {
                    self.add("G0\nG53.1");
                }
            }
            Intent::Mirror(mirrored) => {
                for (k, letter) in ["X", "Y"].iter().enumerate() {
                    if mirrored[k] != (self.mirror[k] < 0.0) {
                        self.add(format!("G5{}.1 {letter}0.", u8::from(mirrored[k])));
                    }
                }
            }
            Intent::Preset { axes } => self.add(format!("G92{}", self.words(axes))),
            Intent::Origin { origin, turn } => {
                self.add(format!("G0\nG10 L2 P2{} R{turn:.5}", self.words(&origin.map(Some))));
            }
            Intent::Level(_) => self.add("G69"),
            Intent::Tcp { is_on, is_vector } => self.add(match (self.language, is_on) {
                (Language::LinuxCnc, true) => "M428".to_owned(),
                (Language::LinuxCnc, false) => "M429".to_owned(),
                (Language::Haas, true) => format!("G234 H{tool}"),
                (_, true) if *is_vector => format!("G43.5 H{tool}"),
                (_, true) => format!("G43.4 H{tool}"),
                (_, false) => "G49".to_owned(),
            }),
            Intent::Vector { place, axis: [i, j, k] } => {
                self.add(format!("G1{} I{i:.8} J{j:.8} K{k:.8}", self.words(&place.map(Some))));
            }
            Intent::Change { tool, .. } => self.add(format!("T{} M6\nS1000 M3", tool + 1)),
            Intent::Length(true) => self.add(format!("G43 H{tool}")),
            Intent::Length(false) => self.add("G49"),
            Intent::Machine { axes } => self.add(format!("G53 G0{}", self.words(axes))),
            Intent::Home { via } => self.add(format!("G28{}", self.words(via))),
            _ => {}
        }
    }

    fn write_klartext(&mut self, intent: &Intent) {
        match intent {
            Intent::Offset(offset) => self.add(format!("CYCL DEF 247 Q339=+{}", offset + 1)),
            Intent::Shift { axes, adds } => {
                self.add("CYCL DEF 7.0 DATUM SHIFT");
                let sign = if *adds { "I" } else { "" };
                for (k, word) in self.words(axes).split_whitespace().enumerate() {
                    self.add(format!("CYCL DEF 7.{} {sign}{word}", k + 1));
                }
            }
            Intent::Rotate { angle, .. } => {
                self.add(format!("CYCL DEF 10.0 ROTATION\nCYCL DEF 10.1 ROT{angle:+.5}"));
            }
            Intent::Mirror(mirrored) => {
                let words = [("X ", mirrored[0]), ("Y ", mirrored[1])];
                let words = words.map(|(word, is_mirrored)| if is_mirrored { word } else { "" });
                self.add(format!("CYCL DEF 8.0 MIRROR\nCYCL DEF 8.1 {}", words.concat()));
            }
            Intent::Tilt(tilt) => {
                self.add(format!(
                    "PLANE {} {}",
                    self.plane_form(tilt),
                    self.positioning(tilt.align)
                ));
                if tilt.align == Align::Separately {
                    let words = ["A+Q120 ", "B+Q121 ", "C+Q122 "].into_iter().enumerate();
                    let words =
                        words.filter(|(k, _)| self.machine.has(k + 3)).map(|(_, word)| word);
                    self.add(format!("L {}R0 FMAX", words.collect::<String>()));
                }
            }
            Intent::Level(align) => {
                if self.inner.rotation.angle() > 1e-12 {
                    self.add("CYCL DEF 10.0 ROTATION\nCYCL DEF 10.1 ROT+0");
                }
                if self.is_tilted {
                    let positioning = self.positioning(align.unwrap_or(Align::Separately));
                    self.add(format!("PLANE RESET {positioning}"));
                }
            }
            Intent::Tcp { is_on, .. } => self.add(if *is_on { "M128" } else { "M129" }),
            Intent::Change { tool, allowance } => {
                let number = tool + 1;
                let allowance = match allowance {
                    0.0 => String::new(),
                    allowance => format!(" DL{}", self.length(*allowance)),
                };
                self.add(format!("TOOL CALL {number} Z S1000{allowance}\nM3"));
            }
            Intent::Machine { axes } => self.add(format!("L{} R0 FMAX M91", self.words(axes))),
            Intent::Retract(distance) => {
                self.add(format!("L M140 MB{:.5} FMAX", distance / self.unit));
            }
            _ => {}
        }
    }

    fn positioning(&self, align: Align) -> String {
        match align {
            Align::Turn => "TURN FMAX".to_owned(),
            Align::Rest | Align::Separately => "STAY".to_owned(),
            Align::About(distance) => format!("MOVE DIST{} FMAX", self.length(distance)),
        }
    }

    fn plane_form(&self, tilt: &Tilt) -> String {
        let [a, b, c] = tilt.angles;
        match tilt.form {
            PlaneForm::Euler => format!("EULER EULPR{a:+.5} EULNU{b:+.5} EULROT{c:+.5}"),
            PlaneForm::Vectors => {
                let rotation = self.rotation_of(tilt);
                let (x, z) = (rotation * Vector3::x(), rotation * Vector3::z());
                format!(
                    "VECTOR BX{:+.8} BY{:+.8} BZ{:+.8} NX{:+.8} NY{:+.8} NZ{:+.8}",
                    x.x, x.y, x.z, z.x, z.y, z.z
                )
            }
            PlaneForm::Relative(axis) => format!("RELATIV {}{a:+.5}", ["SPA", "SPB", "SPC"][axis]),
            _ => format!("SPATIAL SPA{a:+.5} SPB{b:+.5} SPC{c:+.5}"),
        }
    }

    fn write_sinumerik(&mut self, intent: &Intent) {
        match intent {
            Intent::Offset(offset) => self.add(["G54", "G55"][*offset]),
            Intent::Shift { axes, adds } => {
                let word = if *adds { "ATRANS" } else { "TRANS" };
                self.add(format!("{word}{}", self.words(axes)));
            }
            Intent::Rotate { axis, angle } => {
                self.add(format!("AROT {}{angle:.5}", LETTERS[*axis]));
            }
            Intent::Tilt(tilt) => self.write_swivel(tilt),
            Intent::Level(_) => self.add(if self.is_tilted { "CYCLE800()" } else { "TRANS" }),
            Intent::Tcp { is_on, .. } => {
                let word = if *is_on { "TRAORI" } else { "TRAFOOF" };
                self.add(format!("{word}\n{}", ["G54", "G55"][self.offset]));
            }
            Intent::Vector { place, axis: [i, j, k] } => {
                let place = self.words(&place.map(Some));
                self.add(format!("G1{place} A3={i:.8} B3={j:.8} C3={k:.8}"));
            }
            Intent::Change { tool, .. } => self.add(format!("T{} M6\nD1\nS1000 M3", tool + 1)),
            Intent::Length(is_on) => self.add(if *is_on { "D1" } else { "D0" }),
            Intent::Machine { axes } => self.add(format!("G0 SUPA{}", self.words(axes))),
            _ => {}
        }
    }

    fn write_swivel(&mut self, tilt: &Tilt) {
        let PlaneForm::Axes { order: [first, second, third], adds } = tilt.form else { return };
        let lengths = |point: [f64; 3]| point.map(|value| self.length(value)).join(",");
        let (before, after) = (lengths(tilt.before), lengths(tilt.after));
        let angles = tilt.angles.map(|angle| format!("{angle:.5}")).join(",");
        let mode = first + 1 + 4 * (second + 1) + 16 * (third + 1);
        let (retract, distance) = match tilt.retract {
            SwivelRetract::None => (0, String::new()),
            SwivelRetract::Z => (1, String::new()),
            SwivelRetract::All => (2, String::new()),
            SwivelRetract::Along(distance) => (5, self.length(distance)),
        };
        self.add(format!(
            "CYCLE800({retract},\"TC1\",20000{},{mode},{before},{angles},{after},-1,{distance},1)",
            u8::from(adds)
        ));
    }
}
