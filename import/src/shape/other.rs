//! Saws, probes, outlines drawn by hand, and the general cutter of APT.

use super::super::outline::{Outline, cutting, plain};
use super::super::term::Term;
use super::{CORNER, Cutter, FACE, FLUTE, FormSegment, ShapeError, ball_on_neck, positive};

impl Cutter {
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
        outline.line(radius, &zero, FACE);
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
