//! The shapes of cutters, from their dimensions in a tool library.

mod mills;
mod segments;
mod threads;

use super::outline::{Outline, SAME, Surface, Term, cutting, plain};
use ShapeError::{Contradiction, OutOfRange};
use mills::form;
pub(crate) use threads::Crest;

/// The dimensions of a cutter, in the unit of its tool. Lengths are from the tip.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Cutter {
    pub(super) shape: Shape,
    /// The diameter, as the library states it for the shape.
    pub(super) diameter: f64,
    /// The length of the flutes, and of the whole cutter.
    pub(super) flute_length: f64,
    pub(super) length: f64,
    /// The length and the diameter of the neck above the flutes.
    pub(super) shoulder: Option<(f64, Option<f64>)>,
    /// The length of the neck's lower end that cuts.
    pub(super) cutting_neck: f64,
    pub(super) shank_diameter: Option<f64>,
}

/// The cutting part.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Shape {
    /// A cylinder; its lower edge may be rounded.
    Flat {
        corner: f64,
    },
    Ball,
    /// A cone that widens upward from a tip with rounded edge, with half the angle of the cone.
    Tapered {
        corner: f64,
        half_angle: f64,
    },
    /// The same with a ball as tip, of this radius.
    /// The flutes end at the flute length; the cone goes on up to the diameter `cone_to`, if that is larger.
    TaperedBall {
        radius: f64,
        half_angle: f64,
        cone_to: f64,
    },
    /// A cone from a tip over the length of the flutes, with half its angle.
    Cone {
        tip_diameter: f64,
        half_angle: f64,
    },
    /// A cone from a tip up to the diameter at the end of the flutes.
    TruncatedCone {
        tip_diameter: f64,
    },
    /// A cone from a tip, with half its angle, that narrows to the neck in the same way.
    Chamfer {
        tip_diameter: f64,
        half_angle: f64,
    },
    /// A point, with its whole angle; 180 is flat.
    Drill {
        tip_diameter: f64,
        point_angle: f64,
    },
    /// A drill of a smaller diameter that ends at `tip_length` in a cone, both angles whole.
    CenterDrill {
        tip_diameter: f64,
        tip_length: f64,
        point_angle: f64,
        body_angle: f64,
    },
    /// A cone that narrows upward, with half its angle; its lower edge may be rounded.
    Dovetail {
        corner: f64,
        half_angle: f64,
    },
    Lollipop,
    /// A disc with both edges rounded.
    Slot {
        corner: f64,
    },
    /// A concave edge around a tip of the cutter's diameter, up to `max_diameter`.
    Radius {
        corner: f64,
        max_diameter: f64,
    },
    /// Teeth with straight flanks, at most `teeth` of them.
    Thread {
        pitch: f64,
        angle: f64,
        teeth: u32,
        crest: Crest,
    },
    /// A cylinder whose lower edge has a chamfer of this width, at this angle from the plane across the axis.
    CornerChamfer {
        width: f64,
        angle: f64,
    },
    /// A face mill: a cone up to the largest diameter, with rounded edges, with half the angle of the cone.
    Face {
        corner: f64,
        upper: f64,
        half_angle: f64,
        max_diameter: f64,
    },
    /// A flank of radius `flank` whose widest point is at `waist`, with rounded edges below and above.
    Barrel {
        flank: f64,
        waist: f64,
        lower: f64,
        upper: f64,
    },
    /// A face of radius `face` whose centre is on the axis, with a rounded edge.
    Lens {
        face: f64,
        corner: f64,
    },
    /// A ball that passes into a flank of radius `flank`.
    Oval {
        ball: f64,
        flank: f64,
    },
    /// A rounded tip, a flank of radius `flank` that widens upward, and a rounded edge where it ends at the diameter.
    /// Somewhere on it the flank has the angle `half_angle` from the axis.
    SegmentTaper {
        tip_diameter: f64,
        lower: f64,
        flank: f64,
        upper: f64,
        half_angle: f64,
    },
    /// An outline drawn by hand.
    Form(Vec<FormSegment>),
    /// A disc with a clamping screw below it.
    Saw {
        thickness: f64,
        cap_diameter: f64,
        cap_height: f64,
    },
    /// The ball of a touch probe.
    Probe,
    /// One tooth of a thread mill, with a flat crest.
    Tooth {
        neck_diameter: f64,
        crest: f64,
        angle: f64,
    },
    /// APT's general cutter: a line from the tip that rises by `end_angle`, an arc about the point `[d, z]`, and a line that
    /// leaves the axis by `side_angle`.
    General {
        corner: f64,
        centre: [f64; 2],
        end_angle: f64,
        side_angle: f64,
    },
}

/// A segment of an outline drawn by hand: its end, and for an arc the radius and whether it bulges into the material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FormSegment {
    pub(super) to: [f64; 2],
    pub(super) arc: Option<(f64, bool)>,
}

/// Why dimensions are no shape.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub(super) enum ShapeError {
    #[error("the {0} is {1}")]
    OutOfRange(&'static str, f64),
    #[error("the {0}, {1}, does not fit the {2}, {3}")]
    Contradiction(&'static str, f64, &'static str, f64),
    #[error("the library does not state the {0}")]
    Unstated(&'static str),
}

const FACE: Surface = cutting("face");
const CORNER: Surface = cutting("corner");
const FLUTE: Surface = cutting("flute");
const NECK: Surface = plain("neck");
const SHANK: Surface = plain("shank");

impl Cutter {
    /// Returns the half section.
    ///
    /// # Errors
    /// If the dimensions are no solid.
    pub(super) fn outline(&self) -> Result<Outline, ShapeError> {
        positive("diameter", self.diameter)?;
        positive("overall length", self.length)?;
        // A dimension of 0 is not stated.
        let (shoulder, shoulder_diameter) = self.shoulder.unwrap_or((0.0, None));
        for (name, value) in [
            ("flute length", self.flute_length),
            ("shoulder length", shoulder),
            ("shoulder diameter", shoulder_diameter.unwrap_or(0.0)),
            ("shank diameter", self.shank_diameter.unwrap_or(0.0)),
        ] {
            if !(value >= 0.0 && value.is_finite()) {
                return Err(OutOfRange(name, value));
            }
        }
        let mut outline = Outline::new();
        let diameter = outline.param("diameter", self.diameter);
        let radius = outline.define("R", diameter.half());
        self.cutting_part(&mut outline, &radius)?;
        self.body(&mut outline)?;
        Ok(outline)
    }

    fn cutting_part(&self, outline: &mut Outline, radius: &Term) -> Result<(), ShapeError> {
        match self.shape {
            Shape::Flat { corner } => self.flat(outline, radius, corner),
            Shape::Ball => self.ball(outline, radius),
            Shape::Tapered { corner, half_angle } => {
                self.tapered(outline, radius, corner, half_angle)
            }
            Shape::Cone { tip_diameter, half_angle } => {
                self.cone_from_tip(outline, tip_diameter, half_angle)
            }
            Shape::TruncatedCone { tip_diameter } => {
                self.truncated_cone(outline, radius, tip_diameter)
            }
            Shape::TaperedBall { radius: ball, half_angle, cone_to } => {
                self.tapered_ball(outline, ball, half_angle, cone_to)
            }
            Shape::Chamfer { tip_diameter, half_angle } => {
                self.chamfer(outline, radius, tip_diameter, half_angle)
            }
            Shape::Drill { tip_diameter, point_angle } => {
                self.drill(outline, radius, tip_diameter, point_angle)
            }
            Shape::CenterDrill { tip_diameter, tip_length, point_angle, body_angle } => self
                .center_drill(outline, radius, tip_diameter, tip_length, point_angle, body_angle),
            Shape::Dovetail { corner, half_angle } => {
                self.dovetail(outline, radius, corner, half_angle)
            }
            Shape::Lollipop => self.lollipop(outline, radius),
            Shape::Slot { corner } => self.slot(outline, radius, corner),
            Shape::Radius { corner, max_diameter } => {
                self.concave_edge(outline, radius, corner, max_diameter)
            }
            Shape::Tooth { neck_diameter, crest, angle } => {
                self.tooth(outline, radius, neck_diameter, crest, angle)
            }
            Shape::Thread { pitch, angle, teeth, crest } => {
                self.teeth(outline, radius, pitch, angle, teeth, crest)
            }
            Shape::CornerChamfer { width, angle } => {
                self.corner_chamfer(outline, radius, width, angle)
            }
            Shape::Face { corner, upper, half_angle, max_diameter } => {
                self.face(outline, radius, [corner, upper], half_angle, max_diameter)
            }
            Shape::Barrel { flank, waist, lower, upper } => {
                self.barrel(outline, radius, flank, waist, [lower, upper])
            }
            Shape::Lens { face, corner } => self.lens(outline, radius, face, corner),
            Shape::Oval { ball, flank } => self.oval(outline, radius, ball, flank),
            Shape::SegmentTaper { tip_diameter, lower, flank, upper, half_angle } => {
                self.segment_taper(outline, radius, tip_diameter, half_angle, [lower, flank, upper])
            }
            Shape::Form(ref segments) => {
                form(outline, segments);
                Ok(())
            }
            Shape::Saw { thickness, cap_diameter, cap_height } => {
                self.saw(outline, radius, thickness, cap_diameter, cap_height)
            }
            Shape::General { corner, centre, end_angle, side_angle } => {
                self.general(outline, radius, corner, centre, [end_angle, side_angle])
            }
            Shape::Probe => self.probe(outline, radius),
        }
    }

    /// Draws the flutes as a cylinder up to the stated length.
    fn flutes(&self, outline: &mut Outline, radius: &Term) -> Result<(), ShapeError> {
        self.up_to_flute_length(outline, radius, FLUTE)
    }

    /// Draws a cylinder up to the length of the flutes, if that is higher.
    fn up_to_flute_length(
        &self,
        outline: &mut Outline,
        radius: &Term,
        surface: Surface,
    ) -> Result<(), ShapeError> {
        if self.flute_length > outline.end().z.value() {
            let flute = self.flute_param(outline)?;
            outline.line(radius, &flute, surface);
        }
        Ok(())
    }

    /// Draws a flat tip below a cone of radius `R + z tan a`, and its edge, an arc that touches both. Returns the point
    /// where the cone begins.
    fn edge_of_cone(
        &self,
        outline: &mut Outline,
        radius: &Term,
        corner: f64,
        angle: &Term,
    ) -> Result<[Term; 2], ShapeError> {
        let zero = Term::number(0.0);
        if corner == 0.0 {
            flat_end(outline, radius);
            return Ok([radius.clone(), zero]);
        }
        let corner = outline.param("corner_radius", corner);
        let one = Term::number(1.0);
        let inner = radius.minus(&corner.times(&one.minus(&angle.sin())).over(&angle.cos()));
        // The edge's centre would be beyond the axis.
        if inner.value() < 0.0 {
            return Err(Contradiction("corner radius", corner.value(), "diameter", self.diameter));
        }
        let inner = outline.define("inner", inner);
        flat_end(outline, &inner);
        let d = inner.plus(&corner.times(&angle.cos()));
        let z = corner.minus(&corner.times(&angle.sin()));
        outline.arc([&d, &z], [&inner, &corner], CORNER);
        Ok([d, z])
    }

    /// Draws the flutes as a cone.
    fn cone(&self, outline: &mut Outline, to: &Term, flute: &Term) -> Result<(), ShapeError> {
        if flute.value() > outline.end().z.value() {
            outline.line(to, flute, FLUTE);
            Ok(())
        } else {
            let tip = outline.end().z.value();
            Err(Contradiction("flute length", self.flute_length, "tip", tip))
        }
    }

    /// Draws the neck and the shank, up to the cutter's end.
    fn body(&self, outline: &mut Outline) -> Result<(), ShapeError> {
        // An outline drawn by hand ends on the axis itself.
        if matches!(self.shape, Shape::Form(_)) {
            return Ok(());
        }
        let top = outline.end().z.value();
        // Both are sums that were rounded.
        if top > self.length * (1.0 + 1e-9) {
            return Err(Contradiction(
                "overall length",
                self.length,
                "end of the cutting part",
                top,
            ));
        }
        let length = outline.param("length", self.length);
        // A shoulder that ends in the cutting part, or at the tool's end, leaves no neck.
        if let Some((shoulder, diameter)) = self.shoulder
            && shoulder > outline.end().z.value()
            && shoulder < self.length
        {
            let z = outline.param("shoulder_length", shoulder);
            let from = outline.end().clone();
            let d = match diameter {
                Some(diameter) => {
                    positive("shoulder diameter", diameter)?;
                    outline.known_or_param("shoulder_diameter", diameter).half()
                }
                None => from.d.clone(),
            };
            outline.line(&d, &from.z, NECK);
            if self.cutting_neck > 0.0 {
                // Cutting edges end with the neck.
                let edges = outline.param("cutting_neck", self.cutting_neck);
                let end = from.z.plus(&edges);
                let end = if end.value() < shoulder { end } else { z.clone() };
                outline.line(&d, &end, FLUTE);
            }
            outline.line(&d, &z, NECK);
        }
        let from = outline.end().clone();
        let d = match self.shank_diameter {
            Some(diameter) => {
                positive("shank diameter", diameter)?;
                // A shank without a length would be a step that turns straight back.
                if self.length - from.z.value() <= SAME * self.length {
                    from.d.clone()
                } else {
                    outline.known_or_param("shank_diameter", diameter).half()
                }
            }
            None => from.d.clone(),
        };
        outline.line(&d, &from.z, SHANK);
        outline.line(&d, &length, SHANK);
        outline.line(&Term::number(0.0), &length, SHANK);
        Ok(())
    }

    fn flute_param(&self, outline: &mut Outline) -> Result<Term, ShapeError> {
        positive("flute length", self.flute_length)?;
        Ok(outline.known_or_param("flute_length", self.flute_length))
    }

    fn has_neck(&self) -> bool {
        matches!(self.shoulder, Some((length, Some(_))) if length > 0.0)
    }

    /// Returns the diameter right above the cutting part.
    fn neck_diameter(&self) -> f64 {
        let shoulder = self.shoulder.and_then(|(_, diameter)| diameter);
        shoulder.or(self.shank_diameter).unwrap_or(self.diameter)
    }

    fn check_corner(&self, corner: f64) -> Result<(), ShapeError> {
        if !(corner >= 0.0 && corner.is_finite()) {
            return Err(OutOfRange("corner radius", corner));
        }
        if corner > self.diameter / 2.0 {
            return Err(Contradiction("corner radius", corner, "diameter", self.diameter));
        }
        Ok(())
    }

    fn check_tip(&self, tip: f64) -> Result<(), ShapeError> {
        if !(tip >= 0.0 && tip.is_finite()) {
            return Err(OutOfRange("tip diameter", tip));
        }
        if tip > self.diameter {
            return Err(Contradiction("tip diameter", tip, "diameter", self.diameter));
        }
        Ok(())
    }

    fn check_angle(&self, name: &'static str, angle: f64) -> Result<(), ShapeError> {
        if (0.0..90.0).contains(&angle) { Ok(()) } else { Err(OutOfRange(name, angle)) }
    }
}

/// Draws the flat end of a cutter, from the axis to a radius.
fn flat_end(outline: &mut Outline, radius: &Term) {
    outline.line(radius, &Term::number(0.0), FACE);
}

/// Draws the flat tip of a cone, and returns its radius.
fn flat_tip(outline: &mut Outline, diameter: f64) -> Term {
    if diameter == 0.0 {
        return Term::number(0.0);
    }
    let tip = outline.param("tip_diameter", diameter).half();
    flat_end(outline, &tip);
    tip
}

/// Draws a ball up to the neck that leaves it.
fn ball_on_neck(outline: &mut Outline, radius: &Term, neck: &Term, surface: Surface) {
    let zero = Term::number(0.0);
    outline.arc([radius, radius], [&zero, radius], surface);
    let up = radius.plus(&radius.squared().minus(&neck.squared()).sqrt());
    outline.arc([neck, &up], [&zero, radius], surface);
}

fn positive(name: &'static str, value: f64) -> Result<(), ShapeError> {
    if value > 0.0 && value.is_finite() { Ok(()) } else { Err(OutOfRange(name, value)) }
}
