//! Profiles as the tests draw them. Nearest features are found by exhaustive search, the inside by crossings,
//! validity from points along the profile: nothing is shared with the compiler.

use std::fmt::Write as _;

/// A point or vector of the half plane.
pub(crate) type P2 = [f64; 2];

pub(crate) fn sub(a: P2, b: P2) -> P2 {
    [a[0] - b[0], a[1] - b[1]]
}
pub(crate) fn add(a: P2, b: P2, times: f64) -> P2 {
    [a[0] + times * b[0], a[1] + times * b[1]]
}
pub(crate) fn dot(a: P2, b: P2) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}
pub(crate) fn cross(a: P2, b: P2) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}
pub(crate) fn len(a: P2) -> f64 {
    a[0].hypot(a[1])
}
pub(crate) fn unit(a: P2) -> P2 {
    a.map(|part| part / len(a))
}

/// The circle of an arc.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Round {
    pub(crate) centre: P2,
    pub(crate) radius: f64,
    /// Counter-clockwise: it bulges out of the material.
    pub(crate) convex: bool,
    pub(crate) by_radius: bool,
}

/// A line, or an arc of at most 180°; the material lies on its left.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Piece {
    pub(crate) from: P2,
    pub(crate) to: P2,
    pub(crate) round: Option<Round>,
}

impl Piece {
    pub(crate) fn line(from: P2, to: P2) -> Piece {
        Piece { from, to, round: None }
    }

    /// Returns the arc about a centre.
    pub(crate) fn about(from: P2, to: P2, centre: P2, convex: bool) -> Piece {
        let radius = len(sub(from, centre));
        Piece { from, to, round: Some(Round { centre, radius, convex, by_radius: false }) }
    }

    /// Returns the arc of a radius; a radius just below half of the chord makes half a circle.
    pub(crate) fn by_radius(from: P2, to: P2, radius: f64, convex: bool) -> Piece {
        let chord = sub(to, from);
        let half = len(chord) / 2.0;
        let distance = ((radius - half) * (radius + half)).max(0.0).sqrt();
        let normal = unit([-chord[1], chord[0]]);
        let middle = [0, 1].map(|k| f64::midpoint(from[k], to[k]));
        let centre = add(middle, normal, if convex { distance } else { -distance });
        Piece { from, to, round: Some(Round { centre, radius, convex, by_radius: true }) }
    }

    /// Returns the direction of travel at a point of the piece.
    pub(crate) fn tangent(&self, at: P2) -> P2 {
        match self.round {
            None => unit(sub(self.to, self.from)),
            Some(round) => {
                let out = unit(sub(at, round.centre));
                if round.convex { [-out[1], out[0]] } else { [out[1], -out[0]] }
            }
        }
    }

    /// Returns a point of the piece, from 0 at the start to 1 at the end.
    pub(crate) fn at(&self, share: f64) -> P2 {
        let Some(round) = self.round else {
            return add(self.from, sub(self.to, self.from), share);
        };
        let (a, angle) = (sub(self.from, round.centre), self.sweep() * share);
        let (sin, cos) = angle.sin_cos();
        add(round.centre, [a[0] * cos - a[1] * sin, a[0] * sin + a[1] * cos], 1.0)
    }

    /// Returns the angle of an arc in rad, positive counter-clockwise; 0 for a line.
    pub(crate) fn sweep(&self) -> f64 {
        let Some(round) = self.round else { return 0.0 };
        let (a, b) = (sub(self.from, round.centre), sub(self.to, round.centre));
        let angle = cross(a, b).atan2(dot(a, b)).abs();
        if round.convex { angle } else { -angle }
    }

    /// Returns whether the foot of `p` on the whole line or circle lies on the piece.
    pub(crate) fn faces(&self, p: P2) -> bool {
        match self.round {
            None => {
                let along = sub(self.to, self.from);
                let t = dot(sub(p, self.from), along);
                (0.0..=dot(along, along)).contains(&t)
            }
            Some(round) => {
                let middle = unit(sub(self.at(0.5), round.centre));
                let q = sub(p, round.centre);
                let half = self.sweep().abs() / 2.0;
                cross(middle, q).atan2(dot(middle, q)).abs() <= half
            }
        }
    }

    /// Returns the distance to the whole line or circle, positive on the material's side.
    pub(crate) fn signed(&self, p: P2) -> f64 {
        match self.round {
            None => cross(unit(sub(self.to, self.from)), sub(p, self.from)),
            Some(round) => {
                let inward = round.radius - len(sub(p, round.centre));
                if round.convex { inward } else { -inward }
            }
        }
    }

    /// Returns the distance to the piece, and the index of the nearest end if that is the nearest point.
    pub(crate) fn clamped(&self, p: P2) -> (f64, Option<usize>) {
        if self.faces(p) {
            return (self.signed(p).abs(), None);
        }
        let ends = [self.from, self.to].map(|end| len(sub(p, end)));
        if ends[0] <= ends[1] { (ends[0], Some(0)) } else { (ends[1], Some(1)) }
    }

    /// Returns the unit vector out of the material at the foot of `p`.
    pub(crate) fn outward(&self, p: P2) -> P2 {
        match self.round {
            None => {
                let t = unit(sub(self.to, self.from));
                [t[1], -t[0]]
            }
            Some(round) if round.convex => unit(sub(p, round.centre)),
            Some(round) => unit(sub(round.centre, p)),
        }
    }

    /// Returns the piece in parts that do not turn in z, each with its side of the centre.
    fn rising(&self) -> Vec<(P2, P2, f64)> {
        let Some(round) = self.round else { return vec![(self.from, self.to, 0.0)] };
        let order = if cross(sub(self.from, round.centre), [0.0, 1.0]) > 0.0 { 1.0 } else { -1.0 };
        let order = if round.convex { order } else { -order };
        let turns = [round.radius * order, -round.radius * order];
        let mut cuts = vec![self.from];
        for turn in turns.map(|up| [round.centre[0], round.centre[1] + up]) {
            if self.faces(turn) && turn[1] != self.from[1] && turn[1] != self.to[1] {
                cuts.push(turn);
            }
        }
        cuts.push(self.to);
        // The ends of half a circle lie on neither side.
        let middle = self.at(0.5)[0] - round.centre[0];
        let side = |a: P2, b: P2| {
            let sum = a[0] + b[0] - 2.0 * round.centre[0];
            (if sum.abs() < 1e-9 * round.radius { middle } else { sum }).signum()
        };
        cuts.windows(2).map(|w| (w[0], w[1], side(w[0], w[1]))).collect()
    }

    /// Counts the intersections of the piece with the ray from `p` toward larger d.
    fn crossings(&self, p: P2) -> usize {
        let meets = |&(a, b, side): &(P2, P2, f64)| {
            if (a[1] <= p[1]) == (b[1] <= p[1]) {
                return false;
            }
            let d = match self.round {
                None => a[0] + (p[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0]),
                Some(round) => {
                    let up = p[1] - round.centre[1];
                    let square = (round.radius - up) * (round.radius + up);
                    round.centre[0] + side * square.max(0.0).sqrt()
                }
            };
            d > p[0]
        };
        self.rising().iter().filter(|part| meets(part)).count()
    }
}

/// A feature that can be nearest: a piece, or the corner before a piece (behind the last for their number).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Feature {
    Piece(usize),
    Corner(usize),
}

/// A profile in its file's frame.
#[derive(Clone, Debug)]
pub(crate) struct Outline {
    pub(crate) pieces: Vec<Piece>,
    /// True if the spindle lies toward smaller z.
    pub(crate) down: bool,
}

impl Outline {
    /// Returns the largest coordinate.
    pub(crate) fn size(&self) -> f64 {
        let ends = self.pieces.iter().flat_map(|piece| [piece.from, piece.to]);
        ends.flatten().fold(0.0, |largest, part| part.abs().max(largest))
    }

    /// Returns the least and the largest `[d, z]`.
    pub(crate) fn reach(&self) -> [P2; 2] {
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        let mut widen = |p: P2| {
            for k in 0..2 {
                low[k] = low[k].min(p[k]);
                high[k] = high[k].max(p[k]);
            }
        };
        for piece in &self.pieces {
            widen(piece.from);
            widen(piece.to);
            let Some(round) = piece.round else { continue };
            for direction in [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]] {
                let p = add(round.centre, direction, round.radius);
                if piece.faces(p) {
                    widen(p);
                }
            }
        }
        [low, high]
    }

    /// Returns the tip's z.
    pub(crate) fn tip(&self) -> f64 {
        self.reach()[usize::from(self.down)][1]
    }

    /// Transforms a point from the file's frame to the tool's.
    pub(crate) fn turned(&self, [d, z]: P2) -> P2 {
        if self.down { [d, self.tip() - z] } else { [d, z - self.tip()] }
    }

    /// Transforms a point from the tool's frame to the file's.
    pub(crate) fn back(&self, [d, z]: P2) -> P2 {
        if self.down { [d, self.tip() - z] } else { [d, z + self.tip()] }
    }

    /// Returns the `.tool` file; each piece is a surface of its own, `s0` and so on.
    pub(crate) fn text(&self) -> String {
        let frame = if self.down { " spindle -z;" } else { "" };
        let [d, z] = self.pieces[0].from;
        let mut text = format!(
            "tool T {{ units mm; tip z = {};{frame} profile {{\n  start ({d}, {z});\n",
            self.tip()
        );
        for (k, Piece { to: [d, z], round, .. }) in self.pieces.iter().enumerate() {
            let written = match round {
                None => writeln!(text, "  line to ({d}, {z}) as s{k};"),
                Some(round) => {
                    let word = if round.convex { "" } else { "concave " };
                    let [c, h] = round.centre;
                    if round.by_radius {
                        writeln!(text, "  arc to ({d}, {z}) radius {} {word}as s{k};", round.radius)
                    } else {
                        writeln!(text, "  arc to ({d}, {z}) center ({c}, {h}) {word}as s{k};")
                    }
                }
            };
            written.expect("a string takes all");
        }
        text + "} }"
    }

    /// Returns whether a point is inside, by the even-odd rule; undecided on the profile itself.
    pub(crate) fn contains(&self, p: P2) -> bool {
        self.pieces.iter().map(|piece| piece.crossings(p)).sum::<usize>() % 2 == 1
    }

    /// Returns the nearest feature and its distance.
    pub(crate) fn nearest(&self, p: P2) -> (Feature, f64) {
        let each = self.pieces.iter().enumerate().map(|(k, piece)| {
            let (distance, end) = piece.clamped(p);
            (end.map_or(Feature::Piece(k), |end| Feature::Corner(k + end)), distance)
        });
        each.min_by(|a, b| a.1.total_cmp(&b.1)).expect("a profile has pieces")
    }

    /// Returns how much farther than the nearest a feature is, at most; infinite for one that owns nothing.
    pub(crate) fn excess(&self, feature: Feature, p: P2) -> f64 {
        let min_distance = self.nearest(p).1;
        match feature {
            Feature::Piece(k) => {
                let piece = &self.pieces[k];
                (piece.signed(p).abs() - min_distance).abs().max(piece.clamped(p).0 - min_distance)
            }
            Feature::Corner(k) if self.turn(k) < 0.0 => len(sub(p, self.vertex(k))) - min_distance,
            Feature::Corner(_) => f64::INFINITY,
        }
    }

    /// Returns the vertex before a piece, or behind the last.
    pub(crate) fn vertex(&self, k: usize) -> P2 {
        self.pieces.get(k).map_or_else(|| self.pieces[k - 1].to, |piece| piece.from)
    }

    /// Returns the sine of the turn at a vertex, negative at a reflex corner. At the axis the profile meets its
    /// mirror image.
    pub(crate) fn turn(&self, k: usize) -> f64 {
        let [a, b] = self.tangents_at_vertex(k);
        cross(a, b)
    }

    /// Returns the directions of travel into a vertex and out of it.
    pub(crate) fn tangents_at_vertex(&self, k: usize) -> [P2; 2] {
        let at = self.vertex(k);
        let before = k.checked_sub(1).map(|k| self.pieces[k].tangent(at));
        let after = self.pieces.get(k).map(|piece| piece.tangent(at));
        let mirrored = |t: P2| [t[0], -t[1]];
        let a = before.or(after.map(mirrored)).expect("a piece on one side");
        let b = after.or(before.map(mirrored)).expect("a piece on one side");
        [a, b]
    }
}
