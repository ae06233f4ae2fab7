//! Postures of a tool at a triangle, derived from the tool's restatement alone.

use nalgebra::{Point3, Vector3};
use touchoff_tests::oracle::restated;
use touchoff_tests::oracle::{Nearest, Oracle};

type P2 = [f64; 2];

/// A line or an arc of the outline, with lengths in the tool's unit.
struct Piece {
    from: P2,
    to: P2,
    centre: Option<P2>,
    cuts: bool,
}

/// A tool whose postures are derived.
pub struct Stand {
    pieces: Vec<Piece>,
    /// The oracle for its depths.
    pub oracle: Nearest,
    /// The names of its surfaces, and whether each cuts.
    pub surfaces: Vec<(&'static str, bool)>,
    /// The tool's unit of length, in the part's unit.
    pub length: f64,
    /// Up to two heights on the axis, in the tool's unit: the deepest point owned by a cutting surface, if deeper than
    /// the tolerance, and the deepest point owned by another surface.
    pub cores: Vec<f64>,
}

/// A posture of a tool.
#[derive(Clone, Copy, Debug)]
pub struct Posture {
    /// The tip, in the part's unit.
    pub tip: Point3<f64>,
    /// The axis, from the tip to the spindle.
    pub axis: Vector3<f64>,
    /// The quality of the contact.
    pub niceness: f64,
}

/// A sine, or a share of the tool's size, that counts as rounding.
const ROUNDING: f64 = 1e-9;

fn minus(a: P2, b: P2) -> P2 {
    [a[0] - b[0], a[1] - b[1]]
}

fn dot(a: P2, b: P2) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn cross(a: P2, b: P2) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

fn unit(a: P2) -> P2 {
    let size = a[0].hypot(a[1]);
    a.map(|part| part / size)
}

impl Piece {
    /// Returns the tangent of the outline at a point of the piece. The material is on the left.
    fn along(&self, at: P2) -> P2 {
        let Some(centre) = self.centre else { return unit(minus(self.to, self.from)) };
        let [d, z] = unit(minus(at, centre));
        if self.bulges() { [-z, d] } else { [z, -d] }
    }

    /// Returns whether the piece is an arc whose material is around its centre.
    fn bulges(&self) -> bool {
        let of = |centre| cross(minus(self.from, centre), minus(self.to, centre)) > 0.0;
        self.centre.is_some_and(of)
    }
}

impl Stand {
    /// Derives a tool from its restatement. `length` is the tool's unit of length in the part's unit. `tolerance` is
    /// the allowed depth of cutting surfaces, in the part's unit.
    ///
    /// # Errors
    /// If the tool has no restatement.
    pub fn new(name: &str, length: f64, tolerance: f64) -> Result<Stand, String> {
        let tool = restated::of(name).ok_or_else(|| format!("`{name}` is not restated"))?;
        let point = |[d, z]: &restated::Point| [d.to_f64(), z.to_f64()];
        let mut from = point(&tool.start);
        let mut pieces = Vec::new();
        let mut surfaces: Vec<(&'static str, bool)> = Vec::new();
        for way in &tool.ways {
            let (to, centre) = (point(&way.to), way.centre.as_ref().map(point));
            let cuts = tool.cutting.contains(&way.surface);
            pieces.push(Piece { from, to, centre, cuts });
            if surfaces.iter().all(|(name, _)| *name != way.surface) {
                surfaces.push((way.surface, cuts));
            }
            from = to;
        }
        let oracle = Nearest::new(&tool);
        let mut stand = Stand { pieces, oracle, surfaces, length, cores: Vec::new() };
        stand.cores = stand.deepest(tolerance);
        Ok(stand)
    }

    /// Returns all postures in which a cutting surface touches the plane through a point, on a convex arc or at a
    /// corner of the outline. The outline's normal there is opposite to the plane's, or the opposite lies between the
    /// normals of the pieces that meet at the corner. Deviations up to `more` times rounding are accepted.
    pub fn postures(
        &self,
        place: Point3<f64>,
        normal: Vector3<f64>,
        axis: Vector3<f64>,
        more: f64,
    ) -> Vec<Posture> {
        let up = -normal.dot(&axis);
        let across = -normal - up * axis;
        let out = across.norm();
        let way: P2 = [out, up];
        let size = self.oracle.extent()[0].max(self.oracle.extent()[1]);
        // The contact point, and a point slightly inside the piece that touches there.
        let hair = ROUNDING * size;
        let inside = |at: P2, back: P2, piece: P2| {
            [at[0] + hair * (back[0] - 0.02 * piece[1]), at[1] + hair * (back[1] + 0.02 * piece[0])]
        };
        let mut touched: Vec<(P2, [P2; 2])> = Vec::new();
        for (k, piece) in self.pieces.iter().enumerate().filter(|(_, piece)| piece.cuts) {
            if let Some(centre) = piece.centre
                && piece.bulges()
            {
                let radius = minus(piece.from, centre);
                let radius = radius[0].hypot(radius[1]);
                let arms = [piece.from, piece.to].map(|end| unit(minus(end, centre)));
                if cross(arms[0], way) >= -more * ROUNDING
                    && cross(way, arms[1]) >= -more * ROUNDING
                {
                    let on = |radius: f64| [0, 1].map(|k| centre[k] + radius * way[k]);
                    touched.push((on(radius), [on(radius - hair); 2]));
                }
            }
            // The corner before the piece. On the axis, the outline continues as its mirror image.
            let after = piece.along(piece.from);
            let before = match k.checked_sub(1) {
                Some(k) if self.pieces[k].cuts => self.pieces[k].along(piece.from),
                Some(_) => continue,
                None => [after[0], -after[1]],
            };
            let bends = cross(before, after) > ROUNDING;
            let highest =
                dot(before, way) >= -more * ROUNDING && dot(after, way) <= more * ROUNDING;
            if bends && highest {
                let back = before.map(|part| -part);
                let both = [inside(piece.from, back, before), inside(piece.from, after, after)];
                touched.push((piece.from, both));
            }
        }
        let posture = |([d, z], both): (P2, [P2; 2])| {
            // If the tool's axis is parallel to the normal, the contact is a ring without a distinguished point.
            if out < ROUNDING && d > ROUNDING * size {
                return None;
            }
            let radial = if out > 0.0 { across / out } else { Vector3::zeros() };
            let nice = |[d, z]: P2| self.oracle.sense([d, 0.0, z]).map(|sense| sense.niceness);
            // At a corner both pieces touch, and the lower niceness counts.
            let niceness = both.into_iter().filter_map(nice).reduce(f64::min)?;
            let tip = place - self.length * (d * radial + z * axis);
            Some(Posture { tip, axis, niceness })
        };
        touched.into_iter().filter_map(posture).collect()
    }

    /// Returns the largest radius and the height, in the part's unit.
    pub fn extent(&self) -> [f64; 2] {
        self.oracle.extent().map(|part| part * self.length)
    }

    /// Returns the depth of a point of the tool's frame, which is negative outside, and its distances from the cutting
    /// surfaces and from the others. The point is in the tool's unit, the results in the part's.
    pub fn evaluation(&self, at: [f64; 3]) -> [f64; 3] {
        let away = |cuts: bool| {
            let own = self.surfaces.iter().filter(|(_, cutting)| *cutting == cuts);
            own.map(|(name, _)| self.oracle.away(name, at)).fold(f64::INFINITY, f64::min)
        };
        let (cuts, rest) = (away(true), away(false));
        let depth = -self.oracle.signed_distance(at);
        [depth, cuts, rest].map(|part| part * self.length)
    }

    fn deepest(&self, tolerance: f64) -> Vec<f64> {
        const PLACES: u32 = 256;
        let height = self.oracle.extent()[1];
        let heights = (1..PLACES).map(|k| height * f64::from(k) / f64::from(PLACES));
        let evaluation: Vec<(f64, [f64; 3])> =
            heights.map(|z| (z, self.evaluation([0.0, 0.0, z]))).collect();
        let deepest = |of: fn(&[f64; 3]) -> bool, least: f64| {
            let own =
                evaluation.iter().filter(|(_, evaluation)| evaluation[0] > least && of(evaluation));
            own.max_by(|a, b| a.1[0].total_cmp(&b.1[0])).map(|(z, _)| *z)
        };
        let all = [
            deepest(|evaluation| evaluation[1] <= evaluation[2], tolerance),
            deepest(|evaluation| evaluation[2] < evaluation[1], 0.0),
        ];
        all.into_iter().flatten().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchoff_tests::oracle::draw::Rng;

    /// The contact point is on the tool's surface, a point slightly above the plane is inside the tool, and no point
    /// slightly below the plane is.
    #[test]
    fn a_tool_touches_the_plane_that_it_stands_at() {
        let mut draw = Rng::new(5);
        for name in ["D2Ball", "BullNose", "TaperedBall", "Flat", "Drill", "HalfInchBallCat40"] {
            let length = if name.starts_with("Half") { 25.4 } else { 1.0 };
            let stand = Stand::new(name, length, 0.01).expect("a restated tool");
            let mut stood = 0;
            for _ in 0..2_000 {
                let (normal, axis) =
                    (Vector3::from(draw.direction()), Vector3::from(draw.direction()));
                for posture in stand.postures(Point3::origin(), normal, axis, 1.0) {
                    stood += 1;
                    let depth = |place: Vector3<f64>| {
                        let off = (place - posture.tip.coords) / length;
                        let z = off.dot(&axis);
                        -stand.oracle.signed_distance([(off - z * axis).norm(), 0.0, z])
                    };
                    assert!(depth(Vector3::zeros()).abs() < 1e-12, "{name} {posture:?}");
                    assert!(depth(1e-6 * normal) > 0.0, "{name} {posture:?}");
                    for _ in 0..20 {
                        let other = Vector3::from(draw.direction());
                        let on_plane = 1e-3 * (other - normal.dot(&other) * normal);
                        assert!(depth(on_plane - 1e-9 * normal) <= 0.0, "{name} {posture:?}");
                    }
                }
            }
            assert!(stood > 100, "{name}: {stood}");
        }
    }
}
