//! Face mills and circle-segment mills.

use super::ShapeError::{Contradiction, OutOfRange};
use super::{CORNER, Cutter, FACE, FLUTE, Shape, ShapeError, flat_end, flat_tip, positive};
use crate::outline::{Outline, SAME, Term, cutting};

impl Cutter {
    /// Draws a face mill. Its cone goes on to the largest diameter, however long the flutes are.
    pub(super) fn face(
        &self,
        outline: &mut Outline,
        radius: &Term,
        [corner, upper]: [f64; 2],
        half_angle: f64,
        max_diameter: f64,
    ) -> Result<(), ShapeError> {
        self.check_corner(corner)?;
        self.check_angle("taper angle", half_angle)?;
        // There is no cone between both diameters.
        if half_angle == 0.0 || max_diameter <= self.diameter {
            return self.flat(outline, radius, corner);
        }
        let angle = outline.angle("taper_angle", half_angle);
        let wide = outline.param("max_diameter", max_diameter).half();
        let [d, z] = self.edge_of_cone(outline, radius, corner, &angle)?;
        if upper > 0.0 {
            let upper = outline.param("upper_radius", upper);
            let centre_d = wide.minus(&upper);
            let touch_d = centre_d.plus(&upper.times(&angle.cos()));
            let touch_z = z.plus(&touch_d.minus(&d).over(&angle.tan()));
            let centre_z = touch_z.plus(&upper.times(&angle.sin()));
            // The upper edge would begin below the end of the lower one.
            if touch_d.value() < d.value() {
                return Err(Contradiction(
                    "upper radius",
                    upper.value(),
                    "diameter",
                    self.diameter,
                ));
            }
            outline.line(&touch_d, &touch_z, FLUTE);
            outline.arc([&wide, &centre_z], [&centre_d, &centre_z], CORNER);
        } else if wide.value() > d.value() {
            outline.line(&wide, &z.plus(&wide.minus(&d).over(&angle.tan())), FLUTE);
        }
        self.flutes(outline, &wide)
    }

    /// Draws a barrel between the planes of the tip and of the flutes' end, to which its rounded edges are tangent.
    pub(super) fn barrel(
        &self,
        outline: &mut Outline,
        radius: &Term,
        flank: f64,
        waist: f64,
        [lower, upper]: [f64; 2],
    ) -> Result<(), ShapeError> {
        positive("radius of the flank", flank)?;
        let (top, widest) = (self.flute_length, self.diameter / 2.0);
        if !(waist > 0.0 && waist < top) {
            return Err(Contradiction("axial distance", waist, "flute length", top));
        }
        let zero = Term::number(0.0);
        let flank = outline.param("flank_radius", flank);
        let waist = outline.param("axial_distance", waist);
        let top = self.flute_param(outline)?;
        // The flank's centre is beyond the axis, or short of it.
        let axis = outline.define("axis", radius.minus(&flank));
        // At an edge: the distance from the axis of the centre of its arc, and the point where the arc meets the flank.
        // It touches the flank from inside, so that the centres of both are the difference of the radii apart.
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
            // The square of the distance of both centres across the axis.
            let reach = (flank.value() - edge_radius).powi(2) - (half - edge_radius).powi(2);
            let fits = edge_radius >= 0.0 && edge_radius < half && reach > 0.0;
            if !fits || widest - flank.value() + reach.sqrt() <= 0.0 {
                return Err(Contradiction(name, edge_radius, "radius of the flank", flank.value()));
            }
        }
        if lower > 0.0 {
            let lower = outline.param("lower_radius", lower);
            let (inner, touch, along) = edge(&lower, &waist.minus(&lower));
            let inner = outline.define("low", inner);
            flat_end(outline, &inner);
            outline.arc([&touch, &waist.minus(&along)], [&inner, &lower], CORNER);
        } else {
            let (inner, ..) = edge(&zero, &waist);
            flat_end(outline, &inner);
        }
        // Below a wider neck a rounded edge would leave a gap that narrows to nothing.
        let end = radius.value() - flank.value()
            + ((flank.value() - upper).powi(2) - (top.value() - waist.value() - upper).powi(2))
                .sqrt();
        if upper > 0.0 && self.neck_diameter() / 2.0 <= end {
            let upper = outline.param("upper_radius", upper);
            let (inner, touch, along) = edge(&upper, &top.minus(&waist).minus(&upper));
            let inner = outline.define("high", inner);
            outline.arc([&touch, &waist.plus(&along)], [&axis, &waist], cutting("flank"));
            outline.arc([&inner, &top], [&inner, &top.minus(&upper)], CORNER);
        } else {
            let (inner, ..) = edge(&zero, &top.minus(&waist));
            outline.arc([&inner, &top], [&axis, &waist], cutting("flank"));
        }
        Ok(())
    }

    /// Draws a face whose centre is on the axis.
    pub(super) fn lens(
        &self,
        outline: &mut Outline,
        radius: &Term,
        face: f64,
        corner: f64,
    ) -> Result<(), ShapeError> {
        let zero = Term::number(0.0);
        self.check_corner(corner)?;
        if face <= corner || face < self.diameter / 2.0 {
            return Err(Contradiction("radius of the face", face, "diameter", self.diameter));
        }
        // The corner touches the face from inside.
        let face = outline.param("face_radius", face);
        let corner = outline.param("corner_radius", corner);
        let ring = outline.define("ring", radius.minus(&corner));
        let inner = face.minus(&corner);
        let rise = outline.define("rise", inner.squared().minus(&ring.squared()).sqrt());
        let touch_d = ring.times(&face).over(&inner);
        let touch_z = face.minus(&rise.times(&face).over(&inner));
        outline.arc([&touch_d, &touch_z], [&zero, &face], FACE);
        let high = face.minus(&rise);
        outline.arc([radius, &high], [&ring, &high], CORNER);
        self.flutes(outline, radius)
    }

    /// Draws a ball that passes into a flank.
    pub(super) fn oval(
        &self,
        outline: &mut Outline,
        radius: &Term,
        ball: f64,
        flank: f64,
    ) -> Result<(), ShapeError> {
        let zero = Term::number(0.0);
        positive("radius of the tip", ball)?;
        if flank <= ball || flank < self.diameter / 2.0 || ball > self.diameter / 2.0 {
            return Err(Contradiction("radius of the flank", flank, "diameter", self.diameter));
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
        outline.arc([&touch_d, &touch_z], [&zero, &ball], cutting("tip"));
        let axis = zero.minus(&back);
        if self.flute_length < centre_z.value() {
            // The flutes end below the widest point.
            let flute = self.flute_param(outline)?;
            let rest = centre_z.minus(&flute);
            let wide = flank.squared().minus(&rest.squared()).sqrt().minus(&back);
            if flute.value() <= touch_z.value() {
                return Err(Contradiction(
                    "flute length",
                    self.flute_length,
                    "tip",
                    touch_z.value(),
                ));
            }
            outline.arc([&wide, &flute], [&axis, &centre_z], cutting("flank"));
            return Ok(());
        }
        outline.arc([radius, &centre_z], [&axis, &centre_z], cutting("flank"));
        self.flutes(outline, radius)
    }

    /// Returns the diameter of an oval at the end of its flutes, if they end below its widest point; else, and for other
    /// shapes, `None`.
    pub(crate) fn width_of_short_oval(&self) -> Option<f64> {
        let Shape::Oval { ball, flank } = self.shape else { return None };
        let back = flank - self.diameter / 2.0;
        let centre_z = ball + ((flank - ball).powi(2) - back.powi(2)).sqrt();
        let rest = (centre_z - self.flute_length).max(0.0);
        let width = 2.0 * ((flank.powi(2) - rest.powi(2)).sqrt() - back);
        (width > 0.0 && width < self.diameter * (1.0 - SAME)).then_some(width)
    }

    /// Draws a flank that widens upward from a rounded tip and ends in a rounded edge at the diameter.
    ///
    /// Each arc touches the next. The centre of the tip's arc is as far from the axis as the edge of the flat tip, and
    /// that of the upper edge lies at the height where the diameter is reached. The flank may still turn about the centre
    /// of the tip's arc, until one of its points has the taper angle. Here this is its upper end: any other point would
    /// turn the flank toward the axis, so this solid contains those of the other readings.
    pub(super) fn segment_taper(
        &self,
        outline: &mut Outline,
        radius: &Term,
        tip_diameter: f64,
        half_angle: f64,
        [lower, flank, upper]: [f64; 3],
    ) -> Result<(), ShapeError> {
        self.check_tip(tip_diameter)?;
        self.check_angle("taper angle", half_angle)?;
        for (name, edge) in [("lower radius", lower), ("upper radius", upper)] {
            if !(edge >= 0.0 && edge.is_finite()) {
                return Err(OutOfRange(name, edge));
            }
            if edge >= flank {
                return Err(Contradiction(name, edge, "radius of the flank", flank));
            }
        }
        // Lengths below the precision of the library's numbers are none.
        let is_none = |length: f64| length <= SAME * self.diameter;
        let one = Term::number(1.0);
        let tip = flat_tip(outline, if is_none(tip_diameter) { 0.0 } else { tip_diameter });
        let angle = outline.angle("taper_angle", half_angle);
        let flank = outline.param("flank_radius", flank);
        let [lower, upper] =
            [("lower_radius", lower), ("upper_radius", upper)].map(|(name, edge)| {
                if is_none(edge) { Term::number(0.0) } else { outline.param(name, edge) }
            });
        let below = flank.minus(&lower);
        let above = flank.minus(&upper);
        // From the tip's centre it is `below` back to the flank's, and `above` out to the upper edge's, at the flank's angles there.
        // Their distances across the axis give the cosine of the angle at the flank's lower end.
        let cos = tip.minus(radius).plus(&upper).plus(&above.times(&angle.cos())).over(&below);
        // A flank that begins across the axis and still does not reach the diameter.
        if cos.value() < 0.0 {
            return Err(Contradiction(
                "radius of the flank",
                flank.value(),
                "diameter",
                self.diameter,
            ));
        }
        // A tip that reaches it before the flank begins. Then the cosine may be above 1.
        let turn = cos.value().min(1.0).acos() - half_angle.to_radians();
        if flank.value() * turn <= SAME * self.diameter {
            return Err(Contradiction("lower radius", lower.value(), "diameter", self.diameter));
        }
        let cos = outline.define("low_cos", cos);
        let sin = outline.define("low_sin", one.minus(&cos.squared()).sqrt());
        let from_d = tip.plus(&lower.times(&cos));
        let from_z = lower.minus(&lower.times(&sin));
        outline.arc([&from_d, &from_z], [&tip, &lower], cutting("tip"));
        let centre_d = outline.define("flank_center", tip.minus(&below.times(&cos)));
        let centre_z = outline.define("flank_height", lower.plus(&below.times(&sin)));
        let to_d = centre_d.plus(&flank.times(&angle.cos()));
        let to_z = centre_z.minus(&flank.times(&angle.sin()));
        outline.arc([&to_d, &to_z], [&centre_d, &centre_z], cutting("flank"));
        let edge = radius.minus(&upper);
        let end = outline.define("high", centre_z.minus(&above.times(&angle.sin())));
        outline.arc([radius, &end], [&edge, &end], CORNER);
        if end.value() > self.flute_length * (1.0 + SAME) {
            return Err(Contradiction(
                "flute length",
                self.flute_length,
                "height of the full diameter",
                end.value(),
            ));
        }
        self.flutes(outline, radius)
    }

    /// Returns the heights at which a circle-segment taper reaches its diameter, if its flank has the taper angle at the
    /// upper end and if it has it at the lower end; `None` for other shapes.
    ///
    /// If a flank with that angle at the lower end does not reach the diameter, the second height is that of the flank
    /// that is parallel to the axis where it reaches it.
    pub(crate) fn heights_of_diameter(&self) -> Option<[f64; 2]> {
        let Shape::SegmentTaper { tip_diameter, lower, flank, upper, half_angle } = self.shape
        else {
            return None;
        };
        let (below, above) = (flank - lower, flank - upper);
        let apart = (self.diameter - tip_diameter) / 2.0 - upper;
        let cos = half_angle.to_radians().cos();
        let height = |low_cos: f64, high_cos: f64| {
            lower + below * (1.0 - low_cos * low_cos).sqrt()
                - above * (1.0 - high_cos * high_cos).sqrt()
        };
        let steepest = ((above - apart) / below).min(cos);
        Some([
            height((above * cos - apart) / below, cos),
            height(steepest, ((apart + below * steepest) / above).min(1.0)),
        ])
    }
}
