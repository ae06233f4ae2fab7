//! Drills.

use super::super::outline::{Outline, cutting};
use super::super::term::Term;
use super::{Cutter, ShapeError, flat_tip, positive};

impl Cutter {
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
            return Err(ShapeError::OutOfRange("point angle", point_angle));
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
}
