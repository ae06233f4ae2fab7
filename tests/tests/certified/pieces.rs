//! Random tools of one to six pieces, written as regions without a profile, beside and in random blocks: certified answers
//! against samples of the pieces and of the block's faces.
//!
//! `PIECES=10000 cargo test --release -p touchoff-tests --test certified pieces -- --nocapture` examines 10,000 tools.

use crate::pair::{CLEAR, INSIDE, QUERIED, TOUCHING, UNDECIDED, VIOLATIONS, WIDER};
use crate::prelude::*;
use crate::to_tool;
use std::fmt::Write;

const REFUSED: &str = "refused";

/// A solid of revolution, by the cross section right of the axis.
#[derive(Clone, Copy, Debug)]
enum Shape {
    /// A circle about a point: a ball if that is on the axis, and a ring elsewhere.
    Round([f64; 2], f64),
    /// The part of the plane between two distances from the axis and two heights; from the axis on if the first is 0.
    Square([f64; 2], [f64; 2]),
}

/// A shape with a surface of its own, whose depth rises by `slope` per unit of length.
#[derive(Clone, Copy, Debug)]
struct Piece {
    shape: Shape,
    slope: f64,
}

impl Piece {
    /// Returns how deep a point is within the shape, negative outside: a distance there.
    fn signed(&self, [d, z]: [f64; 2]) -> f64 {
        match self.shape {
            Shape::Round([cd, cz], radius) => radius - (d - cd).hypot(z - cz),
            Shape::Square([inner, outer], [low, high]) => {
                let hole = if inner > 0.0 { inner - d } else { f64::NEG_INFINITY };
                let (across, along) = (hole.max(d - outer), (low - z).max(z - high));
                let outside = across.max(0.0).hypot(along.max(0.0));
                if outside > 0.0 { -outside } else { -across.max(along) }
            }
        }
    }

    /// Returns a random point, often on the border.
    fn point(&self, rng: &mut Rng) -> [f64; 2] {
        let share = [1.0, rng.between(0.0, 1.0)][rng.index(2)];
        match self.shape {
            Shape::Round([cd, cz], radius) => {
                let (sin, cos) = rng.between(0.0, std::f64::consts::TAU).sin_cos();
                [(cd + share * radius * cos).abs(), cz + share * radius * sin]
            }
            Shape::Square(across, along) => {
                let [d, z] = [across, along].map(|[low, high]| rng.between(low, high));
                let [on_d, on_z] = [across, along].map(|ends| rng.pick(&ends));
                rng.pick(&[[d, z], [on_d, z], [d, on_z], [on_d, on_z]])
            }
        }
    }

    /// Returns the region in the language.
    fn region(&self, index: usize) -> String {
        let slope = self.slope;
        let (bounds, depth) = match self.shape {
            Shape::Round([cd, cz], radius) => {
                let depth = format!("{radius} - hypot(d - {cd}, z - {cz})");
                (format!("{depth} >= 0"), depth)
            }
            Shape::Square([inner, outer], [low, high]) => {
                let hole = if inner > 0.0 { format!(", d - {inner}") } else { String::new() };
                let hollow = if inner > 0.0 { format!("{inner} <= d, ") } else { String::new() };
                let bounds = format!("{hollow}d <= {outer}, {low} <= z, z <= {high}");
                (bounds, format!("min({outer} - d, z - {low}, {high} - z{hole})"))
            }
        };
        format!(
            "region p{index} as s{index} cutting where {bounds} {{ depth: {slope}*({depth}); }}"
        )
    }
}

/// Returns pieces that do not touch each other: one above the other, and some of them within another's bore.
fn random_pieces(rng: &mut Rng) -> Vec<Piece> {
    let size = rng.power(-1.0, 2.0);
    let mut pieces = Vec::new();
    let mut height = 0.0;
    let mut add = |shape, rng: &mut Rng| {
        let slope = rng.pick(&[1.0, 1.0, 0.5, 3.0]);
        pieces.push(Piece { shape, slope });
    };
    for _ in 0..=rng.index(3) {
        let [half, radius] = [0; 2].map(|_| size * rng.power(-1.5, 0.0));
        let middle = height + half;
        let is_round = rng.once_in(2);
        let core = if is_round { half } else { radius };
        add(
            if is_round {
                Shape::Round([0.0, middle], half)
            } else {
                Shape::Square([0.0, radius], [height, height + 2.0 * half])
            },
            rng,
        );
        if rng.once_in(2) {
            let inner = core + size * rng.power(-2.0, 0.0);
            add(
                if rng.once_in(2) {
                    Shape::Round([inner + half, middle], half)
                } else {
                    let outer = inner + size * rng.power(-1.5, 0.0);
                    Shape::Square([inner, outer], [height, height + 2.0 * half])
                },
                rng,
            );
        }
        height += 2.0 * half + size * rng.power(-2.0, 0.0);
    }
    pieces
}

/// A tool of pieces, what its surfaces are allowed, and a block in its own frame.
#[derive(Debug)]
struct Case {
    pieces: Vec<Piece>,
    allowed: Vec<f64>,
    half: [f64; 3],
    /// The block's place.
    place: Pose,
    size: f64,
}

impl Case {
    fn new(rng: &mut Rng) -> Case {
        let pieces = random_pieces(rng);
        let size = pieces.iter().map(|piece| match piece.shape {
            Shape::Round([d, z], radius) => d.max(z) + radius,
            Shape::Square(across, along) => across[1].max(along[1]),
        });
        let size = size.fold(0.0, f64::max);
        let allowed = pieces.iter().map(|_| {
            let depth = size * rng.power(-3.0, -0.3);
            rng.pick(&[0.0, 0.0, depth, f64::INFINITY])
        });
        let allowed = allowed.collect();
        let least = if rng.once_in(3) { 0.5 } else { -1.5 };
        let half = [0; 3].map(|_| size * rng.power(least, 1.0));
        Case { pieces, allowed, half, place: random_pose([0.0; 3].into(), rng), size }
    }

    fn text(&self) -> String {
        let mut text = "tool Pieces { units mm; tip z = 0; ".to_owned();
        for (index, piece) in self.pieces.iter().enumerate() {
            let _ = write!(text, "{} ", piece.region(index));
        }
        text + "niceness cutting: 1; }"
    }

    /// Returns the block where it lies.
    fn mesh(&self) -> Mesh {
        let Point3 { coords, .. } = Point3::from(self.half);
        let cuboid = block((-coords).into(), coords.into());
        moved(&cuboid, |p| self.place.tip() + self.place.rotation() * p.coords)
    }

    /// Returns a point of the tool where it stands, with its piece.
    fn tool_point(&self, pose: &Pose, rng: &mut Rng) -> (usize, Point3<f64>) {
        let index = rng.index(self.pieces.len());
        let [d, z] = self.pieces[index].point(rng);
        let [cos, sin] = rng.azimuth();
        (index, pose.tip() + pose.rotation() * Vector3::new(d * cos, d * sin, z))
    }

    /// Returns how deep a point is within the block, negative outside.
    fn inside_block(&self, p: Point3<f64>) -> f64 {
        let p = to_tool(&self.place, 1.0, p);
        (0..3).map(|k| self.half[k] - p[k].abs()).fold(f64::INFINITY, f64::min)
    }

    /// Returns the point of a face that is nearest to a point, or sometimes any point of the face.
    fn face_point(&self, p: Point3<f64>, rng: &mut Rng) -> Point3<f64> {
        let mut p = to_tool(&self.place, 1.0, p);
        let face = rng.index(3);
        let is_any = rng.once_in(4);
        for (k, x) in p.iter_mut().enumerate() {
            let half = self.half[k];
            let any = if is_any { rng.between(-half, half) } else { *x };
            *x = if k == face { rng.pick(&[half, -half]) } else { any.clamp(-half, half) };
        }
        self.place.tip() + self.place.rotation() * Vector3::from(p)
    }

    /// Returns a pose at which a point of the tool is near a face.
    fn pose(&self, rng: &mut Rng) -> Pose {
        let turned = random_pose([0.0; 3].into(), rng);
        let (_, on_tool) = self.tool_point(&turned, rng);
        let face = self.face_point(self.place.tip() + Vector3::from(rng.direction()), rng);
        let away = Vector3::from(rng.direction()) * (self.size * rng.power(-3.0, 0.5));
        turned.translated(face + away - on_tool).expect("finite")
    }

    /// Returns the signed depth of a point below each piece's surface, where the tool stands.
    fn depths(&self, pose: &Pose, p: Point3<f64>) -> impl Iterator<Item = f64> {
        let [x, y, z] = to_tool(pose, 1.0, p);
        self.pieces.iter().map(move |piece| piece.slope * piece.signed([x.hypot(y), z]))
    }

    fn certifier<'a>(&self, bvh: &'a TriangleBvh, tool: &'a Interpreted) -> Certifier<'a> {
        let certifier = Certifier::new(bvh, tool).unwrap_or_else(|e| panic!("{e}: {self:?}"));
        allowing(certifier, tool, self.allowed.iter().copied())
    }

    /// Returns samples of the block's faces, most of them nearest to points of the tool.
    fn faces(&self, pose: &Pose, rng: &mut Rng) -> Vec<Point3<f64>> {
        let near = |_| {
            let (_, p) = self.tool_point(pose, rng);
            self.face_point(p, rng)
        };
        (0..400).map(near).collect()
    }

    /// Returns by how much one of some points of the block is too deep; 0 if none is.
    fn excess(&self, pose: &Pose, points: &[Point3<f64>]) -> f64 {
        let excess = |p: &Point3<f64>| {
            let over = self.depths(pose, *p).zip(&self.allowed).map(|(depth, most)| depth - most);
            over.fold(f64::NEG_INFINITY, f64::max)
        };
        points.iter().map(excess).fold(0.0, f64::max)
    }

    /// Returns samples of the block's faces and of what of the tool is in the block.
    fn samples(&self, pose: &Pose, rng: &mut Rng) -> Vec<Point3<f64>> {
        let mut points = self.faces(pose, rng);
        let solid = (0..400).map(|_| self.tool_point(pose, rng).1);
        points.extend(solid.filter(|p| self.inside_block(*p) > 0.0));
        points
    }

    /// Returns bounds of the distance between tool and block: by balls that contain its pieces, and by samples.
    fn distance(&self, pose: &Pose, faces: &[Point3<f64>]) -> [f64; 2] {
        let least = self.pieces.iter().map(|piece| {
            let ([d, z], radius) = match piece.shape {
                Shape::Round([d, z], radius) => ([0.0, z], d + radius),
                Shape::Square([_, outer], [low, high]) => {
                    ([0.0, (low + high) / 2.0], outer.hypot((high - low) / 2.0))
                }
            };
            let centre = pose.tip() + pose.rotation() * Vector3::new(d, 0.0, z);
            let p = to_tool(&self.place, 1.0, centre);
            let beyond = [0, 1, 2].map(|k| (p[k].abs() - self.half[k]).max(0.0));
            Vector3::from(beyond).norm() - radius
        });
        let distance = |p: &Point3<f64>| {
            let [x, y, z] = to_tool(pose, 1.0, *p);
            let depths = self.pieces.iter().map(|piece| piece.signed([x.hypot(y), z]));
            (-depths.fold(f64::NEG_INFINITY, f64::max)).max(0.0)
        };
        let most = faces.iter().map(distance).fold(f64::INFINITY, f64::min);
        [least.fold(f64::INFINITY, f64::min).max(0.0), most]
    }

    /// Returns whether a sampled point of a restricted piece is in the block.
    fn has_inside(&self, pose: &Pose, surface: usize, rng: &mut Rng) -> bool {
        let is_restricted = self.allowed[surface].is_finite();
        let mut own = (0..2000).map(|_| self.tool_point(pose, rng));
        is_restricted && own.any(|(piece, p)| piece == surface && self.inside_block(p) > 0.0)
    }

    /// Returns whether a witness is on the block and deeper than its surface allows.
    fn is_witness(&self, pose: &Pose, witness: &Witness) -> bool {
        let SurfaceId(surface) = witness.surface;
        let depth = self.depths(pose, witness.point).nth(surface).expect("a surface");
        let rounding = 1e-11 * self.size.max(self.half.into_iter().fold(0.0, f64::max));
        self.inside_block(witness.point).abs() <= rounding
            && depth >= self.allowed[surface] - rounding
    }
}

fn random_pose(tip: Point3<f64>, rng: &mut Rng) -> Pose {
    Pose::from_quaternion(tip, rng.quaternion()).expect("a quaternion")
}

/// Asks for depths, clearance and verdicts of one tool.
fn examine(case: &Case, rng: &mut Rng, tally: &mut Tally) {
    let text = case.text();
    let tool: Interpreted = text.parse().unwrap_or_else(|error| panic!("{text}: {error}"));
    let bvh = TriangleBvh::new(&case.mesh());
    if let Err(error) = Certifier::new(&bvh, &tool) {
        tally.find(REFUSED, format!("{error}: {text}"));
        return;
    }
    let (tolerance, rounding) = (1e-3 * case.size, 1e-9 * case.size);
    for _ in 0..3 {
        let pose = case.pose(rng);
        let told = |found: &dyn std::fmt::Debug| {
            let Case { half, place, allowed, .. } = case;
            format!("{found:?} at {pose:?}, allowed {allowed:?}, {half:?} at {place:?}: {text}")
        };
        let faces = case.faces(&pose, rng);
        for surface in 0..case.pieces.len() {
            let mut certifier = Certifier::new(&bvh, &tool).expect("as before");
            let found = certifier.deepest_on(SurfaceId(surface), &pose, tolerance).expect("it");
            let Interval { low, high } = found.depth;
            let depth = |p: Point3<f64>| case.depths(&pose, p).nth(surface).expect("it");
            let sampled = faces.iter().map(|p| depth(*p)).fold(0.0, f64::max);
            tally.add(QUERIED, 1);
            tally.see(WIDER, high - low > 1.01 * tolerance);
            let is_shown = low == 0.0
                || found.witness.as_ref().is_some_and(|w| depth(w.point) >= low - rounding);
            let is_false = sampled > high + rounding || !is_shown;
            tally.never(VIOLATIONS, is_false, || format!("{sampled} deep: {}", told(&found)));
        }
        let clearance = case.certifier(&bvh, &tool).clearance(&pose, tolerance).distance;
        let [least, most] = case.distance(&pose, &faces);
        let is_false = clearance.low > most + rounding || clearance.high < least - rounding;
        tally.never(VIOLATIONS, is_false, || format!("{least} to {most}: {}", told(&clearance)));

        let verdict = case.certifier(&bvh, &tool).check_pose(&pose);
        tally.add(QUERIED, 1);
        let excess = case.excess(&pose, &case.samples(&pose, rng));
        let is_false = match &verdict {
            PoseVerdict::Touching(witness) => !case.is_witness(&pose, witness),
            PoseVerdict::Inside(surface) => !case.has_inside(&pose, surface.0, rng),
            PoseVerdict::Undecided(most) => {
                *most > 0.0 && case.excess(&pose, &faces) > *most + rounding
            }
            _ => excess > rounding,
        };
        tally.see(CLEAR, verdict == PoseVerdict::Clear);
        tally.see(TOUCHING, matches!(verdict, PoseVerdict::Touching(_)));
        tally.see(INSIDE, matches!(verdict, PoseVerdict::Inside(_)));
        tally.see(UNDECIDED, matches!(verdict, PoseVerdict::Undecided(_)));
        tally.never(VIOLATIONS, is_false, || format!("{excess} too deep: {}", told(&verdict)));

        let way = Vector3::from(rng.direction()) * (case.size * rng.power(-3.0, 0.3));
        let at = |time: f64| pose.translated(way * time).expect("finite");
        let path = motion(&pose, &at(1.0));
        let verdict = case.certifier(&bvh, &tool).check_motion(&path, tolerance);
        tally.add(QUERIED, 1);
        tally.see(CLEAR, verdict == MotionVerdict::Clear);
        tally.see(TOUCHING, matches!(verdict, MotionVerdict::Touching(..)));
        tally.see(INSIDE, matches!(verdict, MotionVerdict::Inside(_)));
        tally.see(UNDECIDED, matches!(verdict, MotionVerdict::Undecided(_)));
        let until = match verdict {
            MotionVerdict::Touching(time, _) | MotionVerdict::Undecided(time) => time,
            MotionVerdict::Inside(_) => 0.0,
            _ => 1.0,
        };
        let times = (0..=8).map(|k| until * f64::from(k) / 8.0);
        let excess = times.map(|time| case.excess(&at(time), &case.samples(&at(time), rng)));
        let most = if until > 0.0 { excess.fold(0.0, f64::max) } else { 0.0 };
        let is_false = match &verdict {
            MotionVerdict::Touching(time, witness) => !case.is_witness(&at(*time), witness),
            MotionVerdict::Inside(surface) => !case.has_inside(&pose, surface.0, rng),
            _ => most > tolerance + rounding,
        };
        tally.never(VIOLATIONS, is_false, || {
            format!("{most} too deep by {way:?}: {}", told(&verdict))
        });
    }
}

#[test]
fn tools_of_pieces_without_a_profile_agree_with_samples() {
    let mut rng = Rng::new(61);
    let mut tally = Tally::default();
    for _ in 0..case_count("PIECES", 20) {
        examine(&Case::new(&mut rng), &mut rng, &mut tally);
    }
    eprintln!("{tally}");
    tally.assert_none(REFUSED);
    tally.assert_none(VIOLATIONS);
    let is_seen = |kind| 200 * tally.count(kind) > tally.count(QUERIED);
    assert!([CLEAR, TOUCHING, INSIDE].into_iter().all(is_seen), "{tally}");
    assert!(
        1000 * (tally.count(UNDECIDED) + tally.count(WIDER)) <= tally.count(QUERIED),
        "{tally}"
    );
}
