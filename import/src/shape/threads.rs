//! Thread mills.
//!
//! Pointed teeth are those of the outlines that Fusion 360 posts. Flat and round crests are those of its simulation, to
//! the 0.04 mm to which heights and radii can be read from its pictures: a cutter of several teeth has roots of the form
//! of its crests, and a cutter of one tooth has none.

use super::ShapeError::{Contradiction, OutOfRange};
use super::{Cutter, NECK, ShapeError, positive};
use crate::outline::{Outline, SAME, Surface, Term, cutting};

/// The number of teeth of a thread mill that are drawn.
const MAX_TEETH: f64 = 60.0;

/// The flanks and crests of a thread.
const THREAD: Surface = cutting("thread");

/// The crests of a thread mill's teeth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Crest {
    /// A sharp edge, where the flanks meet.
    Point,
    /// A cylinder of this height.
    Flat { width: f64 },
    /// An arc of this radius, which touches the flanks.
    Round { radius: f64 },
}

/// A thread mill's teeth, in terms of its file.
struct Teeth {
    pitch: Term,
    /// Half of the angle between the flanks of a tooth, in degrees.
    half_angle: Term,
    /// The number that is drawn.
    count: u32,
    /// True if the library states one tooth.
    single: bool,
}

impl Teeth {
    /// Returns the height of a number of pitches.
    fn pitches(&self, number: f64) -> Term {
        let number = Term::number(number);
        if number.value() == 0.0 { number } else { self.pitch.times(&number) }
    }

    /// Returns the error of a crest that does not fit the pitch.
    fn too_large(&self, name: &'static str, crest: f64) -> ShapeError {
        Contradiction(name, crest, "thread pitch", self.pitch.value())
    }
}

/// The arcs of rounded crests.
struct Arcs {
    radius: Term,
    /// The distance along the axis from an arc's centre to the points where it touches flanks.
    rise: Term,
    /// The distance across the axis.
    out: Term,
    /// The distance from the axis of the centres, and of the points where the arcs touch flanks.
    centre: Term,
    touch: Term,
}

impl Cutter {
    /// Returns the number of whole pitches in the length of the flutes; one that fits up to rounding counts.
    pub(crate) fn whole_pitches(&self, pitch: f64) -> f64 {
        (self.flute_length / pitch * (1.0 + 1e-9)).floor().max(0.0)
    }

    /// Draws teeth, a pitch apart, with a neck above them.
    pub(super) fn teeth(
        &self,
        outline: &mut Outline,
        radius: &Term,
        pitch: f64,
        angle: f64,
        teeth: u32,
        crest: Crest,
    ) -> Result<(), ShapeError> {
        if !(0.0..180.0).contains(&angle) || angle == 0.0 {
            return Err(OutOfRange("thread profile angle", angle));
        }
        if pitch == 0.0 {
            return self.flat(outline, radius, 0.0);
        }
        positive("thread pitch", pitch)?;
        let count = self.whole_pitches(pitch).min(f64::from(teeth.max(1)));
        if count > MAX_TEETH {
            return Err(Contradiction("thread pitch", pitch, "flute length", self.flute_length));
        }
        let pitch = outline.param("pitch", pitch);
        let half_angle = outline.angle("thread_angle", angle).half();
        let teeth = Teeth { pitch, half_angle, count: count as u32, single: teeth <= 1 };
        match crest {
            Crest::Point => self.pointed_teeth(outline, radius, &teeth),
            Crest::Flat { width } => self.flat_teeth(outline, radius, &teeth, width),
            Crest::Round { radius: crest } => self.round_teeth(outline, radius, &teeth, crest),
        }
    }

    fn pointed_teeth(
        &self,
        outline: &mut Outline,
        radius: &Term,
        teeth: &Teeth,
    ) -> Result<(), ShapeError> {
        let p = &teeth.pitch;
        let depth = p.over(&Term::number(2.0).times(&teeth.half_angle.tan()));
        let root = self.root(outline, radius.minus(&depth), teeth)?;
        outline.line(&root, &Term::number(0.0), NECK);
        for tooth in 0..teeth.count {
            let k = Term::number(f64::from(tooth));
            // Roots are at whole pitches, and crests between them.
            outline.line(radius, &p.times(&k.plus(&Term::number(0.5))), THREAD);
            outline.line(&root, &teeth.pitches(f64::from(tooth) + 1.0), THREAD);
        }
        self.up_to_flute_length(outline, &root, NECK)
    }

    /// Draws teeth whose crests are cylinders. The roots between several are as high as the crests; one tooth fills the
    /// pitch.
    fn flat_teeth(
        &self,
        outline: &mut Outline,
        radius: &Term,
        teeth: &Teeth,
        width: f64,
    ) -> Result<(), ShapeError> {
        positive("width of the crests", width)?;
        let largest = if teeth.single { teeth.pitch.clone() } else { teeth.pitch.half() };
        let crest = outline.param("crest_width", width);
        let mut flank = largest.minus(&crest);
        if teeth.single {
            flank = flank.half();
        }
        let same = self.same_height();
        if flank.value() < -same {
            return Err(teeth.too_large("width of the crests", width));
        }
        // Crests without flanks between them are a cylinder.
        if flank.value() <= same {
            return self.flat(outline, radius, 0.0);
        }
        let flank = outline.define("flank", flank);
        let depth = flank.over(&teeth.half_angle.tan());
        let root = self.root(outline, radius.minus(&depth), teeth)?;
        for tooth in 0..teeth.count {
            let start = teeth.pitches(f64::from(tooth));
            outline.line(&root, &start, NECK);
            let low = start.plus(&flank);
            let high = low.plus(&crest);
            outline.line(radius, &low, THREAD);
            outline.line(radius, &high, THREAD);
            outline.line(&root, &high.plus(&flank), THREAD);
        }
        if teeth.count == 0 {
            outline.line(&root, &Term::number(0.0), NECK);
        }
        self.up_to_flute_length(outline, &root, NECK)
    }

    /// Draws teeth whose crests are arcs that touch the flanks.
    ///
    /// Continued, the flanks of a tooth of the half angle `q` meet at the distance `R/sin q` from the centre of a crest of
    /// radius `R`. Between several teeth, the roots are arcs of the same radius; the flanks of the lowest tooth begin
    /// where they would touch the root below. One tooth ends in sharp roots.
    fn round_teeth(
        &self,
        outline: &mut Outline,
        radius: &Term,
        teeth: &Teeth,
        crest: f64,
    ) -> Result<(), ShapeError> {
        positive("radius of the crests", crest)?;
        let q = &teeth.half_angle;
        // Arcs as small as the precision of the library's numbers are sharp edges.
        if crest * q.cos().value() <= 2.0 * self.same_height() {
            return self.pointed_teeth(outline, radius, teeth);
        }
        let arcs = self.arcs(outline, radius, teeth, crest)?;
        let (one, two, zero) = (Term::number(1.0), Term::number(2.0), Term::number(0.0));
        let depth = teeth.pitch.over(&two.times(&q.tan()));
        // A crest is below the point where its flanks meet by this much, and a rounded root as much above its own.
        let blunt = arcs.radius.times(&one.over(&q.sin()).minus(&one));
        let sharp = radius.minus(&depth).plus(&blunt);
        let root = if teeth.single { sharp } else { sharp.plus(&blunt) };
        let root = self.root(outline, root, teeth)?;
        if teeth.count == 0 {
            outline.line(&root, &zero, NECK);
            return self.up_to_flute_length(outline, &root, NECK);
        }
        if teeth.single {
            let middle = teeth.pitch.half();
            outline.line(&root, &zero, NECK);
            outline.line(&arcs.touch, &middle.minus(&arcs.rise), THREAD);
            let to = middle.plus(&arcs.rise);
            outline.arc([&arcs.touch, &to], [&arcs.centre, &middle], THREAD);
            outline.line(&root, &teeth.pitch, THREAD);
        } else {
            rounded_teeth(outline, teeth, &arcs, &root);
        }
        // A whole root would touch the end of the flutes.
        let end = self.flute_param(outline)?.minus(&arcs.rise);
        if end.value() > outline.end().z.value() {
            outline.line(&root, &end, NECK);
        }
        Ok(())
    }

    /// Returns the arcs of crests of a radius.
    fn arcs(
        &self,
        outline: &mut Outline,
        radius: &Term,
        teeth: &Teeth,
        crest: f64,
    ) -> Result<Arcs, ShapeError> {
        let q = &teeth.half_angle;
        let per_pitch = Term::number(if teeth.single { 2.0 } else { 4.0 });
        let high = (teeth.pitch.value() - per_pitch.value() * crest * q.cos().value()) / 2.0;
        if high < -self.same_height() {
            return Err(teeth.too_large("radius of the crests", crest));
        }
        // Arcs with a flank near the precision of the library's numbers between them touch each other: the compiler
        // finds no regions about so short a segment.
        let crest = if high * (1.0 / q.tan().value()).min(1.0) <= 4.0 * self.same_height() {
            outline.define("crest_radius", teeth.pitch.over(&per_pitch.times(&q.cos())))
        } else {
            outline.param("crest_radius", crest)
        };
        let rise = outline.define("rise", crest.times(&q.cos()));
        let out = crest.times(&q.sin());
        let centre = outline.define("crest_center", radius.minus(&crest));
        let touch = outline.define("crest_touch", centre.plus(&out));
        Ok(Arcs { radius: crest, rise, out, centre, touch })
    }

    /// Names the radius of the roots, which has to be positive.
    fn root(&self, outline: &mut Outline, root: Term, teeth: &Teeth) -> Result<Term, ShapeError> {
        if root.value() <= 0.0 {
            return Err(Contradiction(
                "thread pitch",
                teeth.pitch.value(),
                "diameter",
                self.diameter,
            ));
        }
        Ok(outline.define("root", root))
    }

    /// Returns the difference below which two heights of the teeth are one.
    fn same_height(&self) -> f64 {
        SAME * self.flute_length.max(self.diameter / 2.0)
    }

    /// Draws one tooth with a flat crest.
    pub(super) fn tooth(
        &self,
        outline: &mut Outline,
        radius: &Term,
        neck_diameter: f64,
        crest: f64,
        angle: f64,
    ) -> Result<(), ShapeError> {
        let zero = Term::number(0.0);
        positive("neck diameter", neck_diameter)?;
        if neck_diameter >= self.diameter || crest < 0.0 {
            return Err(Contradiction("neck diameter", neck_diameter, "diameter", self.diameter));
        }
        self.check_angle("half of the cutting angle", angle / 2.0)?;
        let neck = outline.param("neck_diameter", neck_diameter).half();
        let angle = outline.angle("cutting_angle", angle);
        let high = outline.define("high", radius.minus(&neck).times(&angle.half().tan()));
        outline.line(&neck, &zero, NECK);
        outline.line(radius, &high, cutting("thread"));
        let mut top = high.clone();
        if crest > 0.0 {
            top = high.plus(&outline.param("crest", crest));
            outline.line(radius, &top, cutting("thread"));
        }
        outline.line(&neck, &top.plus(&high), cutting("thread"));
        Ok(())
    }
}

/// Draws several teeth with rounded crests and roots. The last root ends at its lowest point, where the neck begins.
fn rounded_teeth(outline: &mut Outline, teeth: &Teeth, arcs: &Arcs, root: &Term) {
    let groove = outline.define("root_center", root.plus(&arcs.radius));
    let low = outline.define("root_touch", groove.minus(&arcs.out));
    outline.line(&low, &Term::number(0.0), NECK);
    for tooth in 0..teeth.count {
        let top = teeth.pitches(f64::from(tooth) + 0.5);
        let middle = top.minus(&arcs.rise);
        outline.line(&arcs.touch, &middle.minus(&arcs.rise), THREAD);
        outline.arc([&arcs.touch, &top], [&arcs.centre, &middle], THREAD);
        let end = teeth.pitches(f64::from(tooth) + 1.0);
        let bottom = end.minus(&arcs.rise);
        outline.line(&low, &bottom.minus(&arcs.rise), THREAD);
        if tooth + 1 == teeth.count {
            outline.hollow([root, &bottom], [&groove, &bottom], NECK);
        } else {
            outline.hollow([&low, &end], [&groove, &bottom], NECK);
        }
    }
}
