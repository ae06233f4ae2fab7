//! The shapes of cutters, from their dimensions in a tool library.

use super::outline::{Outline, Surface, cutting, plain};
use super::term::Term;

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
    /// A cone from a tip, with half its angle. If `returns`, it narrows to the neck in the same way.
    Chamfer {
        tip_diameter: f64,
        half_angle: f64,
        returns: bool,
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
    /// Triangular teeth, at most `teeth` of them.
    Thread {
        pitch: f64,
        angle: f64,
        teeth: u32,
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
    /// APT's general cutter: a line from the tip that rises by `end_angle`, an arc, and a line that leaves the axis by
    /// `side_angle`.
    General {
        corner: f64,
        centre: (f64, f64),
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

/// The number of teeth of a thread mill that are drawn.
const MAX_TEETH: f64 = 60.0;

impl Cutter {
    /// Returns the half section.
    ///
    /// # Errors
    /// If the dimensions are no solid.
    pub(super) fn outline(&self) -> Result<Outline, ShapeError> {
        positive("diameter", self.diameter)?;
        positive("overall length", self.length)?;
        let mut outline = Outline::new();
        let diameter = outline.param("diameter", self.diameter);
        let radius = outline.define("R", diameter.half());
        self.cutting_part(&mut outline, &radius)?;
        self.body(&mut outline)?;
        Ok(outline)
    }

    fn cutting_part(&self, outline: &mut Outline, radius: &Term) -> Result<(), ShapeError> {
        let zero = Term::number(0.0);
        match self.shape {
            Shape::Flat { corner } => {
                self.check_corner(corner)?;
                if corner == 0.0 {
                    outline.line(radius, &zero, FACE);
                } else {
                    let corner = outline.param("corner_radius", corner);
                    let inner = radius.minus(&corner);
                    outline.line(&inner, &zero, FACE);
                    outline.arc((radius, &corner), (&inner, &corner), CORNER);
                }
                self.flutes(outline, radius)
            }
            Shape::Ball => {
                outline.arc((radius, radius), (&zero, radius), cutting("ball"));
                self.flutes(outline, radius)
            }
            Shape::Tapered { corner, half_angle } => {
                self.check_angle("taper angle", half_angle)?;
                let angle = outline.angle("taper_angle", half_angle);
                if corner == 0.0 {
                    outline.line(radius, &zero, FACE);
                } else {
                    // The arc touches the tip's plane and the cone of radius R + z tan a.
                    let corner = outline.param("corner_radius", corner);
                    let one = Term::number(1.0);
                    let inner =
                        radius.minus(&corner.times(&one.minus(&angle.sin())).over(&angle.cos()));
                    if inner.value() < 0.0 {
                        return Err(ShapeError::Contradiction(
                            "corner radius",
                            corner.value(),
                            "diameter",
                            self.diameter,
                        ));
                    }
                    let inner = outline.define("inner", inner);
                    outline.line(&inner, &zero, FACE);
                    let to_d = inner.plus(&corner.times(&angle.cos()));
                    let to_z = corner.minus(&corner.times(&angle.sin()));
                    outline.arc((&to_d, &to_z), (&inner, &corner), CORNER);
                }
                let flute = self.flute_param(outline)?;
                let wide = radius.plus(&flute.times(&angle.tan()));
                self.cone(outline, &wide, &flute)
            }
            Shape::Cone { tip_diameter, half_angle } => {
                self.check_angle("cutting edge angle", half_angle)?;
                let angle = outline.angle("taper_angle", half_angle);
                let mut tip = zero.clone();
                if tip_diameter > 0.0 {
                    tip = outline.param("tip_diameter", tip_diameter).half();
                    outline.line(&tip, &zero, FACE);
                }
                let flute = self.flute_param(outline)?;
                outline.line(&tip.plus(&flute.times(&angle.tan())), &flute, cutting("cone"));
                Ok(())
            }
            Shape::TaperedBall { radius: ball, half_angle, cone_to } => {
                positive("ball's radius", ball)?;
                self.check_angle("taper angle", half_angle)?;
                let angle = outline.angle("taper_angle", half_angle);
                let ball = outline.param("ball_radius", ball);
                let to_d = ball.times(&angle.cos());
                let to_z = ball.minus(&ball.times(&angle.sin()));
                outline.arc((&to_d, &to_z), (&zero, &ball), cutting("ball"));
                let flute = self.flute_param(outline)?;
                let wide = to_d.plus(&flute.minus(&to_z).times(&angle.tan()));
                self.cone(outline, &wide, &flute)?;
                if cone_to / 2.0 > wide.value() && half_angle > 0.0 {
                    let to = outline.param("taper_diameter", cone_to).half();
                    outline.line(&to, &to_z.plus(&to.minus(&to_d).over(&angle.tan())), NECK);
                }
                Ok(())
            }
            Shape::Chamfer { tip_diameter, half_angle, returns } => {
                self.check_tip(tip_diameter)?;
                self.check_angle("taper angle", half_angle)?;
                if half_angle == 0.0 {
                    return Err(ShapeError::OutOfRange("taper angle", half_angle));
                }
                let tip = outline.param("tip_diameter", tip_diameter).half();
                let angle = outline.angle("taper_angle", half_angle);
                if tip_diameter > 0.0 {
                    outline.line(&tip, &zero, FACE);
                }
                let high = outline.define("high", radius.minus(&tip).over(&angle.tan()));
                outline.line(radius, &high, cutting("cone"));
                let neck = self.neck_diameter();
                if returns && neck < self.diameter {
                    let neck = outline.param("shoulder_diameter", neck).half();
                    let up = high.plus(&radius.minus(&neck).over(&angle.tan()));
                    outline.line(&neck, &up, cutting("cone"));
                    if self.flute_length > up.value() {
                        let flute = self.flute_param(outline)?;
                        outline.line(&neck, &flute, NECK);
                    }
                    return Ok(());
                }
                self.flutes(outline, radius)
            }
            Shape::Drill { tip_diameter, point_angle } => {
                self.check_tip(tip_diameter)?;
                if !(0.0..=180.0).contains(&point_angle) || point_angle == 0.0 {
                    return Err(ShapeError::OutOfRange("point angle", point_angle));
                }
                if point_angle == 180.0 {
                    outline.line(radius, &zero, FACE);
                    return self.flutes(outline, radius);
                }
                let angle = outline.angle("point_angle", point_angle);
                let mut tip = zero.clone();
                if tip_diameter > 0.0 {
                    tip = outline.param("tip_diameter", tip_diameter).half();
                    outline.line(&tip, &zero, FACE);
                }
                let high = radius.minus(&tip).over(&angle.half().tan());
                outline.line(radius, &high, cutting("point"));
                self.flutes(outline, radius)
            }
            Shape::CenterDrill { tip_diameter, tip_length, point_angle, body_angle } => {
                positive("tip diameter", tip_diameter)?;
                self.check_tip(tip_diameter)?;
                for (name, angle) in [("point angle", point_angle), ("body angle", body_angle)] {
                    if !(0.0..180.0).contains(&angle) || angle == 0.0 {
                        return Err(ShapeError::OutOfRange(name, angle));
                    }
                }
                let pilot = outline.param("tip_diameter", tip_diameter).half();
                let length = outline.param("tip_length", tip_length);
                let point = outline.angle("point_angle", point_angle).half();
                let body = outline.angle("body_angle", body_angle).half();
                let high = pilot.over(&point.tan());
                if high.value() > tip_length {
                    return Err(ShapeError::Contradiction(
                        "tip length",
                        tip_length,
                        "point of the pilot",
                        high.value(),
                    ));
                }
                outline.line(&pilot, &high, cutting("point"));
                outline.line(&pilot, &length, cutting("pilot"));
                let up = length.plus(&radius.minus(&pilot).over(&body.tan()));
                outline.line(radius, &up, cutting("cone"));
                self.flutes(outline, radius)
            }
            Shape::Dovetail { corner, half_angle } => {
                self.check_corner(corner)?;
                self.check_angle("dovetail angle", half_angle)?;
                let angle = outline.angle("dovetail_angle", half_angle);
                let mut edge = radius.clone();
                let mut from = zero.clone();
                if corner == 0.0 {
                    outline.line(radius, &zero, FACE);
                } else {
                    // The arc passes the widest point before it meets the cone, which narrows upward.
                    let corner = outline.param("corner_radius", corner);
                    let inner = radius.minus(&corner);
                    outline.line(&inner, &zero, FACE);
                    edge = inner.plus(&corner.times(&angle.cos()));
                    from = corner.plus(&corner.times(&angle.sin()));
                    outline.arc((&edge, &from), (&inner, &corner), CORNER);
                }
                let flute = self.flute_param(outline)?;
                let narrow = edge.minus(&flute.minus(&from).times(&angle.tan()));
                if narrow.value() <= 0.0 {
                    return Err(ShapeError::Contradiction(
                        "flute length",
                        self.flute_length,
                        "dovetail angle",
                        half_angle,
                    ));
                }
                self.cone(outline, &narrow, &flute)
            }
            Shape::Lollipop => {
                let neck = self.neck_diameter();
                if neck >= self.diameter {
                    outline.arc((radius, radius), (&zero, radius), cutting("ball"));
                    return self.flutes(outline, radius);
                }
                positive("neck's diameter", neck)?;
                let name = if self.has_neck() { "shoulder_diameter" } else { "shank_diameter" };
                let neck = outline.param(name, neck).half();
                outline.arc((radius, radius), (&zero, radius), cutting("ball"));
                let up = radius.plus(&radius.squared().minus(&neck.squared()).sqrt());
                outline.arc((&neck, &up), (&zero, radius), cutting("ball"));
                Ok(())
            }
            Shape::Slot { corner } => {
                self.check_corner(corner)?;
                if corner == 0.0 {
                    outline.line(radius, &zero, FACE);
                    return self.flutes(outline, radius);
                }
                let corner = outline.param("corner_radius", corner);
                // A disc thinner than its two edges is as thick as they are.
                let high = if self.flute_length > 2.0 * corner.value() {
                    self.flute_param(outline)?
                } else {
                    corner.times(&Term::number(2.0))
                };
                let inner = radius.minus(&corner);
                let upper = high.minus(&corner);
                outline.line(&inner, &zero, FACE);
                outline.arc((radius, &corner), (&inner, &corner), CORNER);
                // Below a wider neck a rounded edge would leave a gap that narrows to nothing.
                if self.neck_diameter() / 2.0 > inner.value() {
                    outline.line(radius, &high, FLUTE);
                    return Ok(());
                }
                outline.line(radius, &upper, FLUTE);
                outline.arc((&inner, &high), (&inner, &upper), CORNER);
                Ok(())
            }
            Shape::Radius { corner, max_diameter } => {
                outline.line(radius, &zero, FACE);
                if corner <= 0.0 {
                    return self.flutes(outline, radius);
                }
                let corner = outline.param("corner_radius", corner);
                let centre = outline.define("wide", radius.plus(&corner));
                if max_diameter / 2.0 >= centre.value() {
                    outline.hollow((&centre, &corner), (&centre, &zero), CORNER);
                    return self.flutes(outline, &centre);
                }
                let wide = outline.param("max_diameter", max_diameter).half();
                if wide.value() <= radius.value() {
                    return Err(ShapeError::Contradiction(
                        "diameter",
                        max_diameter,
                        "tip diameter",
                        self.diameter,
                    ));
                }
                let up = corner.squared().minus(&centre.minus(&wide).squared()).sqrt();
                outline.hollow((&wide, &up), (&centre, &zero), CORNER);
                self.flutes(outline, &wide)
            }
            Shape::Tooth { neck_diameter, crest, angle } => {
                positive("neck diameter", neck_diameter)?;
                if neck_diameter >= self.diameter || crest < 0.0 {
                    return Err(ShapeError::Contradiction(
                        "neck diameter",
                        neck_diameter,
                        "diameter",
                        self.diameter,
                    ));
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
            Shape::Thread { pitch, angle, teeth } => {
                self.teeth(outline, radius, (pitch, angle, teeth))
            }
            Shape::CornerChamfer { width, angle } => {
                self.check_corner(width)?;
                self.check_angle("chamfer angle", angle)?;
                let width = outline.param("chamfer_width", width);
                let angle = outline.angle("chamfer_angle", angle);
                outline.line(&radius.minus(&width), &zero, FACE);
                outline.line(radius, &width.times(&angle.tan()), cutting("chamfer"));
                self.flutes(outline, radius)
            }
            Shape::Face { corner, upper, half_angle, max_diameter } => {
                self.face(outline, radius, [corner, upper], (half_angle, max_diameter))
            }
            Shape::Barrel { flank, waist, lower, upper } => {
                self.barrel(outline, radius, (flank, waist), [lower, upper])
            }
            Shape::Lens { face, corner } => {
                self.check_corner(corner)?;
                if face <= corner || face < self.diameter / 2.0 {
                    return Err(ShapeError::Contradiction(
                        "radius of the face",
                        face,
                        "diameter",
                        self.diameter,
                    ));
                }
                // The corner touches the face from inside.
                let face = outline.param("face_radius", face);
                let corner = outline.param("corner_radius", corner);
                let ring = outline.define("ring", radius.minus(&corner));
                let inner = face.minus(&corner);
                let rise = outline.define("rise", inner.squared().minus(&ring.squared()).sqrt());
                let touch_d = ring.times(&face).over(&inner);
                let touch_z = face.minus(&rise.times(&face).over(&inner));
                outline.arc((&touch_d, &touch_z), (&zero, &face), FACE);
                let high = face.minus(&rise);
                outline.arc((radius, &high), (&ring, &high), CORNER);
                self.flutes(outline, radius)
            }
            Shape::Oval { ball, flank } => {
                positive("radius of the tip", ball)?;
                if flank <= ball || flank < self.diameter / 2.0 || ball > self.diameter / 2.0 {
                    return Err(ShapeError::Contradiction(
                        "radius of the flank",
                        flank,
                        "diameter",
                        self.diameter,
                    ));
                }
                // The ball touches the flank from inside. The flank's centre lies beyond the axis.
                let ball = outline.param("tip_radius", ball);
                let flank = outline.param("flank_radius", flank);
                let back = outline.define("back", flank.minus(radius));
                let apart = flank.minus(&ball);
                let high = outline.define("high", apart.squared().minus(&back.squared()).sqrt());
                let touch_d = back.times(&flank).over(&apart).minus(&back);
                let centre_z = ball.plus(&high);
                let touch_z = centre_z.minus(&high.times(&flank).over(&apart));
                outline.arc((&touch_d, &touch_z), (&zero, &ball), cutting("tip"));
                let axis = zero.minus(&back);
                if self.flute_length < centre_z.value() {
                    // The flutes end below the widest point.
                    let flute = self.flute_param(outline)?;
                    let rest = centre_z.minus(&flute);
                    let wide = flank.squared().minus(&rest.squared()).sqrt().minus(&back);
                    if flute.value() <= touch_z.value() {
                        return Err(ShapeError::Contradiction(
                            "flute length",
                            self.flute_length,
                            "tip",
                            touch_z.value(),
                        ));
                    }
                    outline.arc((&wide, &flute), (&axis, &centre_z), cutting("flank"));
                    return Ok(());
                }
                outline.arc((radius, &centre_z), (&axis, &centre_z), cutting("flank"));
                self.flutes(outline, radius)
            }
            Shape::Form(ref segments) => {
                for segment in segments {
                    let [d, z] = segment.to.map(Term::number);
                    match segment.arc {
                        None => outline.line(&d, &z, cutting("form")),
                        Some((radius, concave)) => {
                            outline.arc_of_radius(
                                (&d, &z),
                                &Term::number(radius),
                                concave,
                                cutting("form"),
                            );
                        }
                    }
                }
                Ok(())
            }
            Shape::Saw { thickness, cap_diameter, cap_height } => {
                positive("blade thickness", thickness)?;
                let thickness = outline.param("blade_thickness", thickness);
                if cap_diameter > 0.0 && cap_height > 0.0 {
                    let cap = outline.param("cap_diameter", cap_diameter).half();
                    let height = outline.param("cap_height", cap_height);
                    outline.line(&cap, &zero, plain("cap"));
                    outline.line(&cap, &height, plain("cap"));
                    outline.line(radius, &height, FACE);
                    let top = height.plus(&thickness);
                    outline.line(radius, &top, FLUTE);
                    return Ok(());
                }
                outline.line(radius, &zero, FACE);
                outline.line(radius, &thickness, FLUTE);
                Ok(())
            }
            Shape::General { corner, centre, end_angle, side_angle } => {
                self.general(outline, radius, (corner, centre), [end_angle, side_angle])
            }
            Shape::Probe => {
                let stem = self.shank_diameter.unwrap_or(self.diameter);
                if stem >= self.diameter {
                    outline.arc((radius, radius), (&zero, radius), plain("ball"));
                    return Ok(());
                }
                let stem = outline.param("shank_diameter", stem).half();
                outline.arc((radius, radius), (&zero, radius), plain("ball"));
                let up = radius.plus(&radius.squared().minus(&stem.squared()).sqrt());
                outline.arc((&stem, &up), (&zero, radius), plain("ball"));
                Ok(())
            }
        }
    }

    /// Draws a face mill. Its cone goes on to the largest diameter, however long the flutes are.
    fn face(
        &self,
        outline: &mut Outline,
        radius: &Term,
        [corner, upper]: [f64; 2],
        (half_angle, max_diameter): (f64, f64),
    ) -> Result<(), ShapeError> {
        self.check_corner(corner)?;
        self.check_angle("taper angle", half_angle)?;
        let zero = Term::number(0.0);
        if half_angle == 0.0 || max_diameter <= self.diameter {
            if corner == 0.0 {
                outline.line(radius, &zero, FACE);
            } else {
                let corner = outline.param("corner_radius", corner);
                let inner = radius.minus(&corner);
                outline.line(&inner, &zero, FACE);
                outline.arc((radius, &corner), (&inner, &corner), CORNER);
            }
            return self.flutes(outline, radius);
        }
        let angle = outline.angle("taper_angle", half_angle);
        let wide = outline.param("max_diameter", max_diameter).half();
        let [mut d, mut z] = [radius.clone(), zero.clone()];
        if corner == 0.0 {
            outline.line(radius, &zero, FACE);
        } else {
            let corner = outline.param("corner_radius", corner);
            let one = Term::number(1.0);
            let inner = radius.minus(&corner.times(&one.minus(&angle.sin())).over(&angle.cos()));
            let inner = outline.define("inner", inner);
            outline.line(&inner, &zero, FACE);
            d = inner.plus(&corner.times(&angle.cos()));
            z = corner.minus(&corner.times(&angle.sin()));
            outline.arc((&d, &z), (&inner, &corner), CORNER);
        }
        if upper > 0.0 {
            let upper = outline.param("upper_radius", upper);
            let centre_d = wide.minus(&upper);
            let touch_d = centre_d.plus(&upper.times(&angle.cos()));
            let touch_z = z.plus(&touch_d.minus(&d).over(&angle.tan()));
            let centre_z = touch_z.plus(&upper.times(&angle.sin()));
            if touch_d.value() < d.value() {
                return Err(ShapeError::Contradiction(
                    "upper radius",
                    upper.value(),
                    "diameter",
                    self.diameter,
                ));
            }
            outline.line(&touch_d, &touch_z, FLUTE);
            outline.arc((&wide, &centre_z), (&centre_d, &centre_z), CORNER);
        } else if wide.value() > d.value() {
            outline.line(&wide, &z.plus(&wide.minus(&d).over(&angle.tan())), FLUTE);
        }
        self.flutes(outline, &wide)
    }

    /// Draws a barrel between the planes of the tip and of the flutes' end, to which its rounded edges are tangent.
    fn barrel(
        &self,
        outline: &mut Outline,
        radius: &Term,
        (flank, waist): (f64, f64),
        [lower, upper]: [f64; 2],
    ) -> Result<(), ShapeError> {
        positive("radius of the flank", flank)?;
        let (top, widest) = (self.flute_length, self.diameter / 2.0);
        if !(waist > 0.0 && waist < top) {
            return Err(ShapeError::Contradiction("axial distance", waist, "flute length", top));
        }
        let zero = Term::number(0.0);
        let flank = outline.param("flank_radius", flank);
        let waist = outline.param("axial_distance", waist);
        let top = self.flute_param(outline)?;
        // The flank's centre is beyond the axis, or short of it.
        let axis = outline.define("axis", radius.minus(&flank));
        // At an edge: the distance from the axis of the centre of its arc, and the point where the arc meets the flank.
        let edge = |edge_radius: &Term, from_waist: &Term| {
            let apart = flank.minus(edge_radius);
            let inner = axis.plus(&apart.squared().minus(&from_waist.squared()).sqrt());
            let touch = axis.plus(&inner.minus(&axis).times(&flank).over(&apart));
            let along = from_waist.times(&flank).over(&apart);
            (inner, touch, along)
        };
        for (name, edge_radius, half) in [
            ("lower radius", lower, waist.value()),
            ("upper radius", upper, top.value() - waist.value()),
        ] {
            let reach = (flank.value() - edge_radius).powi(2) - (half - edge_radius).powi(2);
            let fits = edge_radius >= 0.0 && edge_radius < half && reach > 0.0;
            if !fits || widest - flank.value() + reach.sqrt() <= 0.0 {
                return Err(ShapeError::Contradiction(
                    name,
                    edge_radius,
                    "radius of the flank",
                    flank.value(),
                ));
            }
        }
        if lower > 0.0 {
            let lower = outline.param("lower_radius", lower);
            let (inner, touch, along) = edge(&lower, &waist.minus(&lower));
            let inner = outline.define("low", inner);
            outline.line(&inner, &zero, FACE);
            outline.arc((&touch, &waist.minus(&along)), (&inner, &lower), CORNER);
        } else {
            let (inner, ..) = edge(&zero, &waist);
            outline.line(&inner, &zero, FACE);
        }
        // Below a wider neck a rounded edge would leave a gap that narrows to nothing.
        let end = radius.value() - flank.value()
            + ((flank.value() - upper).powi(2) - (top.value() - waist.value() - upper).powi(2))
                .sqrt();
        if upper > 0.0 && self.neck_diameter() / 2.0 <= end {
            let upper = outline.param("upper_radius", upper);
            let (inner, touch, along) = edge(&upper, &top.minus(&waist).minus(&upper));
            let inner = outline.define("high", inner);
            outline.arc((&touch, &waist.plus(&along)), (&axis, &waist), cutting("flank"));
            outline.arc((&inner, &top), (&inner, &top.minus(&upper)), CORNER);
        } else {
            let (inner, ..) = edge(&zero, &top.minus(&waist));
            outline.arc((&inner, &top), (&axis, &waist), cutting("flank"));
        }
        Ok(())
    }

    /// Draws the flutes as a cylinder up to the stated length.
    fn flutes(&self, outline: &mut Outline, radius: &Term) -> Result<(), ShapeError> {
        if self.flute_length > outline.end().1.value() {
            let flute = self.flute_param(outline)?;
            outline.line(radius, &flute, FLUTE);
        }
        Ok(())
    }

    /// Draws the flutes as a cone.
    fn cone(&self, outline: &mut Outline, to: &Term, flute: &Term) -> Result<(), ShapeError> {
        if flute.value() > outline.end().1.value() {
            outline.line(to, flute, FLUTE);
            Ok(())
        } else {
            let tip = outline.end().1.value();
            Err(ShapeError::Contradiction("flute length", self.flute_length, "tip", tip))
        }
    }

    /// Draws triangular teeth, a pitch apart, with a neck between their roots.
    fn teeth(
        &self,
        outline: &mut Outline,
        radius: &Term,
        (pitch, angle, teeth): (f64, f64, u32),
    ) -> Result<(), ShapeError> {
        if !(0.0..180.0).contains(&angle) || angle == 0.0 {
            return Err(ShapeError::OutOfRange("thread profile angle", angle));
        }
        if pitch <= 0.0 {
            outline.line(radius, &Term::number(0.0), FACE);
            return self.flutes(outline, radius);
        }
        let zero = Term::number(0.0);
        // A tooth that fits up to rounding is drawn.
        let fits = (self.flute_length / pitch * (1.0 + 1e-9)).floor();
        let count = fits.min(f64::from(teeth.max(1)));
        if count > MAX_TEETH {
            return Err(ShapeError::Contradiction(
                "thread pitch",
                pitch,
                "flute length",
                self.flute_length,
            ));
        }
        let p = outline.param("pitch", pitch);
        let a = outline.angle("thread_angle", angle);
        let root = radius.minus(&p.over(&Term::number(2.0).times(&a.half().tan())));
        if root.value() <= 0.0 {
            return Err(ShapeError::Contradiction(
                "thread pitch",
                pitch,
                "diameter",
                self.diameter,
            ));
        }
        let root = outline.define("root", root);
        outline.line(&root, &zero, plain("neck"));
        for tooth in 0..count as u32 {
            let k = Term::number(f64::from(tooth));
            outline.line(radius, &p.times(&k.plus(&Term::number(0.5))), cutting("thread"));
            outline.line(&root, &p.times(&Term::number(f64::from(tooth) + 1.0)), cutting("thread"));
        }
        if self.flute_length > outline.end().1.value() {
            let flute = self.flute_param(outline)?;
            outline.line(&root, &flute, NECK);
        }
        Ok(())
    }

    /// Draws APT's general cutter. The lines touch the arc where they meet it.
    fn general(
        &self,
        outline: &mut Outline,
        radius: &Term,
        (corner, (centre_d, centre_z)): (f64, (f64, f64)),
        [end, side]: [f64; 2],
    ) -> Result<(), ShapeError> {
        self.check_angle("angle of the end", end)?;
        self.check_angle("angle of the side", side)?;
        if !(corner >= 0.0 && corner.is_finite() && centre_d.is_finite() && centre_z.is_finite()) {
            return Err(ShapeError::OutOfRange("corner radius", corner));
        }
        let end = outline.angle("end_angle", end);
        let side = outline.angle("side_angle", side);
        let flute = self.flute_param(outline)?;
        if corner == 0.0 {
            let high = radius.times(&end.tan());
            outline.line(radius, &high, FACE);
            let wide = radius.plus(&flute.minus(&high).times(&side.tan()));
            return self.cone(outline, &wide, &flute);
        }
        let corner = outline.param("corner_radius", corner);
        let d = outline.param("center_radius", centre_d);
        let z = outline.param("center_height", centre_z);
        let low = [d.plus(&corner.times(&end.sin())), z.minus(&corner.times(&end.cos()))];
        let high = [d.plus(&corner.times(&side.cos())), z.minus(&corner.times(&side.sin()))];
        // The end's line has to touch the arc, and the side's line to meet the end's at the stated diameter.
        let tolerance = 1e-3 * self.diameter;
        let end_misses = low[1].value() - low[0].value() * end.value().to_radians().tan();
        let at_edge = radius.value() * end.value().to_radians().tan();
        let side_at_edge =
            high[0].value() + (at_edge - high[1].value()) * side.value().to_radians().tan();
        if low[0].value() < 0.0 || end_misses.abs() > tolerance {
            return Err(ShapeError::Contradiction(
                "height of the corner's centre",
                centre_z,
                "corner radius",
                corner.value(),
            ));
        }
        if (side_at_edge - radius.value()).abs() > tolerance {
            return Err(ShapeError::Contradiction(
                "corner's centre",
                centre_d,
                "diameter",
                self.diameter,
            ));
        }
        outline.line(&low[0], &low[0].times(&end.tan()), FACE);
        outline.arc((&high[0], &high[1]), (&d, &z), CORNER);
        let wide = high[0].plus(&flute.minus(&high[1]).times(&side.tan()));
        self.cone(outline, &wide, &flute)
    }

    /// Draws the neck and the shank, up to the cutter's end.
    fn body(&self, outline: &mut Outline) -> Result<(), ShapeError> {
        // An outline drawn by hand ends on the axis itself.
        if matches!(self.shape, Shape::Form(_)) {
            return Ok(());
        }
        let top = outline.end().1.value();
        if top > self.length * (1.0 + 1e-9) {
            return Err(ShapeError::Contradiction(
                "overall length",
                self.length,
                "end of the cutting part",
                top,
            ));
        }
        let length = outline.param("length", self.length);
        if let Some((shoulder, diameter)) = self.shoulder
            && shoulder > outline.end().1.value()
            && shoulder < self.length
        {
            let z = outline.param("shoulder_length", shoulder);
            let from = outline.end().clone();
            let d = match diameter {
                Some(diameter) => {
                    positive("shoulder diameter", diameter)?;
                    outline.known_or_param("shoulder_diameter", diameter).half()
                }
                None => from.0.clone(),
            };
            outline.line(&d, &from.1, NECK);
            outline.line(&d, &z, NECK);
        }
        let from = outline.end().clone();
        let d = match self.shank_diameter {
            Some(diameter) => {
                positive("shank diameter", diameter)?;
                outline.known_or_param("shank_diameter", diameter).half()
            }
            None => from.0.clone(),
        };
        outline.line(&d, &from.1, SHANK);
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
            return Err(ShapeError::OutOfRange("corner radius", corner));
        }
        if corner > self.diameter / 2.0 {
            return Err(ShapeError::Contradiction(
                "corner radius",
                corner,
                "diameter",
                self.diameter,
            ));
        }
        Ok(())
    }

    fn check_tip(&self, tip: f64) -> Result<(), ShapeError> {
        if !(tip >= 0.0 && tip.is_finite()) {
            return Err(ShapeError::OutOfRange("tip diameter", tip));
        }
        if tip > self.diameter {
            return Err(ShapeError::Contradiction("tip diameter", tip, "diameter", self.diameter));
        }
        Ok(())
    }

    fn check_angle(&self, name: &'static str, angle: f64) -> Result<(), ShapeError> {
        if (0.0..90.0).contains(&angle) { Ok(()) } else { Err(ShapeError::OutOfRange(name, angle)) }
    }
}

fn positive(name: &'static str, value: f64) -> Result<(), ShapeError> {
    if value > 0.0 && value.is_finite() { Ok(()) } else { Err(ShapeError::OutOfRange(name, value)) }
}
