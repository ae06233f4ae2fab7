//! Drills and thread mills.

use super::super::outline::{Outline, cutting};
use super::super::term::Term;
use super::{Cutter, NECK, ShapeError, flat_tip, positive};

/// The number of teeth of a thread mill that are drawn.
const MAX_TEETH: f64 = 60.0;

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

    /// Draws triangular teeth, a pitch apart, with a neck between their roots.
    pub(super) fn teeth(
        &self,
        outline: &mut Outline,
        radius: &Term,
        (pitch, angle, teeth): (f64, f64, u32),
    ) -> Result<(), ShapeError> {
        if !(0.0..180.0).contains(&angle) || angle == 0.0 {
            return Err(ShapeError::OutOfRange("thread profile angle", angle));
        }
        if pitch <= 0.0 {
            return self.flat(outline, radius, 0.0);
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
        outline.line(&root, &zero, NECK);
        for tooth in 0..count as u32 {
            let k = Term::number(f64::from(tooth));
            outline.line(radius, &p.times(&k.plus(&Term::number(0.5))), cutting("thread"));
            outline.line(&root, &p.times(&Term::number(f64::from(tooth) + 1.0)), cutting("thread"));
        }
        self.up_to_flute_length(outline, &root, NECK)
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
}
