//! Cutters of lines, edges and balls: mills, drills, saws and probes, outlines drawn by hand, and the general cutter of APT.

use super::ShapeError::{Contradiction, OutOfRange};
use super::{
    CORNER, Cutter, FACE, FLUTE, FormSegment, NECK, ShapeError, ball_on_neck, flat_end, flat_tip,
    positive,
};
use crate::outline::{Outline, Term, cutting, plain};

impl Cutter {
    /// Draws a cylinder; its lower edge may be rounded.
    pub(super) fn flat(
        &self,
        outline: &mut Outline,
        radius: &Term,
        corner: f64,
    ) -> Result<(), ShapeError> {
        self.check_corner(corner)?;
        if corner == 0.0 {
            flat_end(outline, radius);
        } else {
            let corner = outline.param("corner_radius", corner);
            let inner = radius.minus(&corner);
            flat_end(outline, &inner);
            outline.arc([radius, &corner], [&inner, &corner], CORNER);
        }
        self.flutes(outline, radius)
    }

    /// Draws a ball.
    pub(super) fn ball(&self, outline: &mut Outline, radius: &Term) -> Result<(), ShapeError> {
        let zero = Term::number(0.0);
        outline.arc([radius, radius], [&zero, radius], cutting("ball"));
        self.flutes(outline, radius)
    }

    /// Draws a cone from a flat tip.
    pub(super) fn tapered(
        &self,
        outline: &mut Outline,
        radius: &Term,
        corner: f64,
        half_angle: f64,
    ) -> Result<(), ShapeError> {
        self.check_angle("taper angle", half_angle)?;
        let angle = outline.angle("taper_angle", half_angle);
        self.edge_of_cone(outline, radius, corner, &angle)?;
        let flute = self.flute_param(outline)?;
        let wide = radius.plus(&flute.times(&angle.tan()));
        self.cone(outline, &wide, &flute)
    }

    /// Draws a cone from a ball that it touches.
    pub(super) fn tapered_ball(
        &self,
        outline: &mut Outline,
        ball: f64,
        half_angle: f64,
        cone_to: f64,
    ) -> Result<(), ShapeError> {
        let zero = Term::number(0.0);
        positive("ball's radius", ball)?;
        self.check_angle("taper angle", half_angle)?;
        let angle = outline.angle("taper_angle", half_angle);
        let ball = outline.param("ball_radius", ball);
        // Where the cone touches the ball, both have one normal.
        let to_d = ball.times(&angle.cos());
        let to_z = ball.minus(&ball.times(&angle.sin()));
        outline.arc([&to_d, &to_z], [&zero, &ball], cutting("ball"));
        let flute = self.flute_param(outline)?;
        let wide = to_d.plus(&flute.minus(&to_z).times(&angle.tan()));
        self.cone(outline, &wide, &flute)?;
        if cone_to / 2.0 > wide.value() && half_angle > 0.0 {
            let to = outline.param("taper_diameter", cone_to).half();
            outline.line(&to, &to_z.plus(&to.minus(&to_d).over(&angle.tan())), NECK);
        }
        Ok(())
    }

    /// Draws a cone from a tip over the length of the flutes.
    pub(super) fn cone_from_tip(
        &self,
        outline: &mut Outline,
        tip_diameter: f64,
        half_angle: f64,
    ) -> Result<(), ShapeError> {
        self.check_angle("cutting edge angle", half_angle)?;
        let angle = outline.angle("taper_angle", half_angle);
        let tip = flat_tip(outline, tip_diameter);
        let flute = self.flute_param(outline)?;
        outline.line(&tip.plus(&flute.times(&angle.tan())), &flute, cutting("cone"));
        Ok(())
    }

    /// Draws a cone from a tip up to the diameter at the end of the flutes.
    pub(super) fn truncated_cone(
        &self,
        outline: &mut Outline,
        radius: &Term,
        tip_diameter: f64,
    ) -> Result<(), ShapeError> {
        self.check_tip(tip_diameter)?;
        flat_tip(outline, tip_diameter);
        let flute = self.flute_param(outline)?;
        outline.line(radius, &flute, cutting("cone"));
        Ok(())
    }

    /// Draws a cone from a tip and, if the neck is narrower, the same cone back to it.
    pub(super) fn chamfer(
        &self,
        outline: &mut Outline,
        radius: &Term,
        tip_diameter: f64,
        half_angle: f64,
    ) -> Result<(), ShapeError> {
        self.check_tip(tip_diameter)?;
        self.check_angle("taper angle", half_angle)?;
        if half_angle == 0.0 {
            return Err(OutOfRange("taper angle", half_angle));
        }
        let tip = outline.param("tip_diameter", tip_diameter).half();
        let angle = outline.angle("taper_angle", half_angle);
        if tip_diameter > 0.0 {
            flat_end(outline, &tip);
        }
        let high = outline.define("high", radius.minus(&tip).over(&angle.tan()));
        outline.line(radius, &high, cutting("cone"));
        let neck = self.neck_diameter();
        if neck < self.diameter {
            let neck = outline.param("shoulder_diameter", neck).half();
            let up = high.plus(&radius.minus(&neck).over(&angle.tan()));
            outline.line(&neck, &up, cutting("cone"));
            return self.up_to_flute_length(outline, &neck, NECK);
        }
        self.flutes(outline, radius)
    }

    /// Draws a cylinder whose lower edge has a chamfer.
    pub(super) fn corner_chamfer(
        &self,
        outline: &mut Outline,
        radius: &Term,
        width: f64,
        angle: f64,
    ) -> Result<(), ShapeError> {
        self.check_corner(width)?;
        self.check_angle("chamfer angle", angle)?;
        let width = outline.param("chamfer_width", width);
        let angle = outline.angle("chamfer_angle", angle);
        flat_end(outline, &radius.minus(&width));
        outline.line(radius, &width.times(&angle.tan()), cutting("chamfer"));
        self.flutes(outline, radius)
    }

    /// Draws a cone that narrows upward.
    pub(super) fn dovetail(
        &self,
        outline: &mut Outline,
        radius: &Term,
        corner: f64,
        half_angle: f64,
    ) -> Result<(), ShapeError> {
        let zero = Term::number(0.0);
        self.check_corner(corner)?;
        self.check_angle("dovetail angle", half_angle)?;
        let angle = outline.angle("dovetail_angle", half_angle);
        let mut edge = radius.clone();
        let mut from = zero.clone();
        if corner == 0.0 {
            flat_end(outline, radius);
        } else {
            // The arc passes the widest point before it meets the cone, which narrows upward.
            let corner = outline.param("corner_radius", corner);
            let inner = radius.minus(&corner);
            flat_end(outline, &inner);
            edge = inner.plus(&corner.times(&angle.cos()));
            from = corner.plus(&corner.times(&angle.sin()));
            outline.arc([&edge, &from], [&inner, &corner], CORNER);
        }
        let flute = self.flute_param(outline)?;
        let narrow = edge.minus(&flute.minus(&from).times(&angle.tan()));
        if narrow.value() <= 0.0 {
            return Err(Contradiction(
                "flute length",
                self.flute_length,
                "dovetail angle",
                half_angle,
            ));
        }
        self.cone(outline, &narrow, &flute)
    }

    /// Draws a ball on a neck.
    pub(super) fn lollipop(&self, outline: &mut Outline, radius: &Term) -> Result<(), ShapeError> {
        let neck = self.neck_diameter();
        // A neck as wide as the ball leaves its lower half.
        if neck >= self.diameter {
            return self.ball(outline, radius);
        }
        positive("neck's diameter", neck)?;
        let name = if self.has_neck() { "shoulder_diameter" } else { "shank_diameter" };
        let neck = outline.param(name, neck).half();
        ball_on_neck(outline, radius, &neck, cutting("ball"));
        Ok(())
    }

    /// Draws a disc.
    pub(super) fn slot(
        &self,
        outline: &mut Outline,
        radius: &Term,
        corner: f64,
    ) -> Result<(), ShapeError> {
        self.check_corner(corner)?;
        if corner == 0.0 {
            flat_end(outline, radius);
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
        flat_end(outline, &inner);
        outline.arc([radius, &corner], [&inner, &corner], CORNER);
        // Below a wider neck a rounded edge would leave a gap that narrows to nothing.
        if self.neck_diameter() / 2.0 > inner.value() {
            outline.line(radius, &high, FLUTE);
            return Ok(());
        }
        outline.line(radius, &upper, FLUTE);
        outline.arc([&inner, &high], [&inner, &upper], CORNER);
        Ok(())
    }

    /// Draws a concave edge around a tip.
    pub(super) fn concave_edge(
        &self,
        outline: &mut Outline,
        radius: &Term,
        corner: f64,
        max_diameter: f64,
    ) -> Result<(), ShapeError> {
        let zero = Term::number(0.0);
        flat_end(outline, radius);
        if corner <= 0.0 {
            return self.flutes(outline, radius);
        }
        let corner = outline.param("corner_radius", corner);
        let centre = outline.define("wide", radius.plus(&corner));
        // The whole quarter of the circle is below the largest diameter.
        if max_diameter / 2.0 >= centre.value() {
            outline.hollow([&centre, &corner], [&centre, &zero], CORNER);
            return self.flutes(outline, &centre);
        }
        let wide = outline.param("max_diameter", max_diameter).half();
        if wide.value() <= radius.value() {
            return Err(Contradiction("diameter", max_diameter, "tip diameter", self.diameter));
        }
        let up = corner.squared().minus(&centre.minus(&wide).squared()).sqrt();
        outline.hollow([&wide, &up], [&centre, &zero], CORNER);
        self.flutes(outline, &wide)
    }

    /// Draws a point.
    pub(super) fn drill(
        &self,
        outline: &mut Outline,
        radius: &Term,
        tip_diameter: f64,
        point_angle: f64,
    ) -> Result<(), ShapeError> {
        self.check_tip(tip_diameter)?;
        if !(0.0..=180.0).contains(&point_angle) || point_angle == 0.0 {
            return Err(OutOfRange("point angle", point_angle));
        }
        if point_angle == 180.0 {
            return self.flat(outline, radius, 0.0);
        }
        let angle = outline.angle("point_angle", point_angle);
        let tip = flat_tip(outline, tip_diameter);
        let high = radius.minus(&tip).over(&angle.half().tan());
        outline.line(radius, &high, cutting("point"));
        self.flutes(outline, radius)
    }

    /// Draws a pilot and the cone of the body.
    pub(super) fn center_drill(
        &self,
        outline: &mut Outline,
        radius: &Term,
        tip_diameter: f64,
        tip_length: f64,
        point_angle: f64,
        body_angle: f64,
    ) -> Result<(), ShapeError> {
        positive("tip diameter", tip_diameter)?;
        self.check_tip(tip_diameter)?;
        for (name, angle) in [("point angle", point_angle), ("body angle", body_angle)] {
            if !(0.0..180.0).contains(&angle) || angle == 0.0 {
                return Err(OutOfRange(name, angle));
            }
        }
        let pilot = outline.param("tip_diameter", tip_diameter).half();
        let length = outline.param("tip_length", tip_length);
        let point = outline.angle("point_angle", point_angle).half();
        let body = outline.angle("body_angle", body_angle).half();
        let high = pilot.over(&point.tan());
        if high.value() > tip_length {
            return Err(Contradiction(
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

    /// Draws a blade with a clamping screw below.
    pub(super) fn saw(
        &self,
        outline: &mut Outline,
        radius: &Term,
        thickness: f64,
        cap_diameter: f64,
        cap_height: f64,
    ) -> Result<(), ShapeError> {
        let zero = Term::number(0.0);
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
        flat_end(outline, radius);
        outline.line(radius, &thickness, FLUTE);
        Ok(())
    }

    /// Draws the ball of a probe.
    pub(super) fn probe(&self, outline: &mut Outline, radius: &Term) -> Result<(), ShapeError> {
        let zero = Term::number(0.0);
        let stem = self.shank_diameter.unwrap_or(self.diameter);
        if stem >= self.diameter {
            outline.arc([radius, radius], [&zero, radius], plain("ball"));
            return Ok(());
        }
        let stem = outline.param("shank_diameter", stem).half();
        ball_on_neck(outline, radius, &stem, plain("ball"));
        Ok(())
    }

    /// Draws APT's general cutter. The lines touch the arc where they meet it.
    pub(super) fn general(
        &self,
        outline: &mut Outline,
        radius: &Term,
        corner: f64,
        [centre_d, centre_z]: [f64; 2],
        [end, side]: [f64; 2],
    ) -> Result<(), ShapeError> {
        self.check_angle("angle of the end", end)?;
        self.check_angle("angle of the side", side)?;
        if !(corner >= 0.0 && corner.is_finite() && centre_d.is_finite() && centre_z.is_finite()) {
            return Err(OutOfRange("corner radius", corner));
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
        // Where a line touches the arc, both have one normal.
        let low = [d.plus(&corner.times(&end.sin())), z.minus(&corner.times(&end.cos()))];
        let high = [d.plus(&corner.times(&side.cos())), z.minus(&corner.times(&side.sin()))];
        // The end's line has to touch the arc, and the side's line to meet the end's at the stated diameter.
        let tolerance = 1e-3 * self.diameter;
        let end_misses = low[1].value() - low[0].value() * end.value().to_radians().tan();
        let at_edge = radius.value() * end.value().to_radians().tan();
        let side_at_edge =
            high[0].value() + (at_edge - high[1].value()) * side.value().to_radians().tan();
        if low[0].value() < 0.0 || end_misses.abs() > tolerance {
            return Err(Contradiction(
                "height of the corner's centre",
                centre_z,
                "corner radius",
                corner.value(),
            ));
        }
        if (side_at_edge - radius.value()).abs() > tolerance {
            return Err(Contradiction("corner's centre", centre_d, "diameter", self.diameter));
        }
        outline.line(&low[0], &low[0].times(&end.tan()), FACE);
        outline.arc([&high[0], &high[1]], [&d, &z], CORNER);
        let wide = high[0].plus(&flute.minus(&high[1]).times(&side.tan()));
        self.cone(outline, &wide, &flute)
    }
}

/// Draws an outline that was drawn by hand.
pub(super) fn form(outline: &mut Outline, segments: &[FormSegment]) {
    for segment in segments {
        let [d, z] = segment.to.map(Term::number);
        match segment.arc {
            None => outline.line(&d, &z, cutting("form")),
            Some((radius, concave)) => {
                let radius = Term::number(radius);
                outline.arc_of_radius([&d, &z], &radius, concave, cutting("form"));
            }
        }
    }
}
