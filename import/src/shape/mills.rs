//! End mills and other milling cutters of lines and edges.

use super::super::outline::{Outline, cutting};
use super::super::term::Term;
use super::{CORNER, Cutter, FACE, FLUTE, NECK, ShapeError, ball_on_neck, flat_tip, positive};

impl Cutter {
    /// Draws a cylinder; its lower edge may be rounded.
    pub(super) fn flat(
        &self,
        outline: &mut Outline,
        radius: &Term,
        corner: f64,
    ) -> Result<(), ShapeError> {
        let zero = Term::number(0.0);
        self.check_corner(corner)?;
        if corner == 0.0 {
            outline.line(radius, &zero, FACE);
        } else {
            let corner = outline.param("corner_radius", corner);
            let inner = radius.minus(&corner);
            outline.line(&inner, &zero, FACE);
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
        let zero = Term::number(0.0);
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
        let zero = Term::number(0.0);
        self.check_corner(width)?;
        self.check_angle("chamfer angle", angle)?;
        let width = outline.param("chamfer_width", width);
        let angle = outline.angle("chamfer_angle", angle);
        outline.line(&radius.minus(&width), &zero, FACE);
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
            outline.line(radius, &zero, FACE);
        } else {
            // The arc passes the widest point before it meets the cone, which narrows upward.
            let corner = outline.param("corner_radius", corner);
            let inner = radius.minus(&corner);
            outline.line(&inner, &zero, FACE);
            edge = inner.plus(&corner.times(&angle.cos()));
            from = corner.plus(&corner.times(&angle.sin()));
            outline.arc([&edge, &from], [&inner, &corner], CORNER);
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

    /// Draws a ball on a neck.
    pub(super) fn lollipop(&self, outline: &mut Outline, radius: &Term) -> Result<(), ShapeError> {
        let zero = Term::number(0.0);
        let neck = self.neck_diameter();
        if neck >= self.diameter {
            outline.arc([radius, radius], [&zero, radius], cutting("ball"));
            return self.flutes(outline, radius);
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
        let zero = Term::number(0.0);
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
        outline.line(radius, &zero, FACE);
        if corner <= 0.0 {
            return self.flutes(outline, radius);
        }
        let corner = outline.param("corner_radius", corner);
        let centre = outline.define("wide", radius.plus(&corner));
        if max_diameter / 2.0 >= centre.value() {
            outline.hollow([&centre, &corner], [&centre, &zero], CORNER);
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
        outline.hollow([&wide, &up], [&centre, &zero], CORNER);
        self.flutes(outline, &wide)
    }
}
