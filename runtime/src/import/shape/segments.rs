//! Face mills and circle-segment mills.

use super::super::outline::{Outline, cutting};
use super::super::term::Term;
use super::{CORNER, Cutter, FACE, FLUTE, ShapeError, positive};

impl Cutter {
    /// Draws a face mill. Its cone goes on to the largest diameter, however long the flutes are.
    pub(super) fn face(
        &self,
        outline: &mut Outline,
        radius: &Term,
        [corner, upper]: [f64; 2],
        (half_angle, max_diameter): (f64, f64),
    ) -> Result<(), ShapeError> {
        self.check_corner(corner)?;
        self.check_angle("taper angle", half_angle)?;
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
    pub(super) fn barrel(
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
}
