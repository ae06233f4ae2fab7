//! Profiles along which z does not fall, in doubles. A depth takes some tens of nanoseconds, for searches that need
//! many.

use super::restated::Restated;

/// A point `[d, z]`.
pub type MeridianPoint = [f64; 2];

/// A segment of a profile: its ends, and its centre if it is an arc.
#[derive(Clone, Copy, Debug)]
pub struct Segment {
    /// Its lower end.
    pub from: MeridianPoint,
    /// Its upper end.
    pub to: MeridianPoint,
    /// The centre of an arc.
    pub centre: Option<MeridianPoint>,
}

/// A profile from the tip up.
#[derive(Clone, Debug)]
pub struct Outline {
    /// Its segments.
    pub segments: Vec<Segment>,
}

fn length(v: MeridianPoint) -> f64 {
    (v[0] * v[0] + v[1] * v[1]).sqrt()
}

impl Outline {
    /// Creates a profile of these segments.
    ///
    /// # Panics
    /// If z falls along one.
    pub fn new(segments: Vec<Segment>) -> Outline {
        assert!(segments.iter().all(Segment::rises), "z falls along a piece: {segments:?}");
        Outline { segments }
    }

    /// Returns the profile of a restated tool; `None` if it overhangs.
    pub fn of(tool: &Restated) -> Option<Outline> {
        let double = |[d, z]: &[super::big::Big; 2]| [d.to_f64(), z.to_f64()];
        let mut from = double(&tool.start);
        let mut segments = Vec::new();
        for segment in &tool.segments {
            let to = double(&segment.to);
            segments.push(Segment { from, to, centre: segment.centre.as_ref().map(double) });
            from = to;
        }
        segments.iter().all(Segment::rises).then_some(Outline { segments })
    }

    /// Returns the depth of a point; below 0 outside.
    pub fn depth(&self, p: MeridianPoint) -> f64 {
        let distance = self.segments.iter().map(|segment| segment.distance(p));
        let distance = distance.fold(f64::INFINITY, f64::min);
        let inside = self.segments.iter().any(|segment| segment.covers(p));
        if inside { distance } else { -distance }
    }
}

impl Segment {
    /// Returns whether the segment is an arc that bulges into the material.
    pub fn is_concave(&self) -> bool {
        let Segment { from, to, centre } = self;
        centre.is_some_and(|[d, z]| (from[0] - d) * (to[1] - z) < (from[1] - z) * (to[0] - d))
    }

    /// Returns whether z does not fall along the segment, and an arc stays on one side of its centre.
    fn rises(&self) -> bool {
        let Segment { from, to, centre } = self;
        let one_side = centre.is_none_or(|[d, _]| (from[0] - d) * (to[0] - d) >= 0.0);
        from[1] <= to[1] && one_side
    }

    fn distance(&self, p: MeridianPoint) -> f64 {
        let Segment { from, to, centre } = self;
        let offset = |q: &MeridianPoint| length([p[0] - q[0], p[1] - q[1]]);
        let Some(centre) = centre else {
            let along = [to[0] - from[0], to[1] - from[1]];
            let square = along[0] * along[0] + along[1] * along[1];
            let part = (p[0] - from[0]) * along[0] + (p[1] - from[1]) * along[1];
            let part = (part / square).clamp(0.0, 1.0);
            return offset(&[from[0] + part * along[0], from[1] + part * along[1]]);
        };
        let arm = |q: MeridianPoint| [q[0] - centre[0], q[1] - centre[1]];
        let cross = |a: MeridianPoint, b: MeridianPoint| a[0] * b[1] - a[1] * b[0];
        let (a, b, q) = (arm(*from), arm(*to), arm(p));
        let turn = cross(a, b).signum();
        if turn * cross(a, q) >= 0.0 && turn * cross(q, b) >= 0.0 {
            (length(q) - length(a)).abs()
        } else {
            offset(from).min(offset(to))
        }
    }

    /// Returns whether the segment is level with a point, and the point lies between it and the axis.
    fn covers(&self, [d, z]: MeridianPoint) -> bool {
        let Segment { from, to, centre } = self;
        if z < from[1] || z > to[1] || from[1] == to[1] {
            return false;
        }
        let Some(centre) = centre else {
            return d <= from[0] + (z - from[1]) / (to[1] - from[1]) * (to[0] - from[0]);
        };
        let radius = length([from[0] - centre[0], from[1] - centre[1]]);
        let up = z - centre[1];
        let across = ((radius - up) * (radius + up)).max(0.0).sqrt();
        d <= centre[0] + if self.is_concave() { -across } else { across }
    }
}
