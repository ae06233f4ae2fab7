//! The kinematics of a machine's file in 256-bit arithmetic, as a product of 3 × 4 matrices.

use dashu_float::FBig;
use dashu_float::round::mode::HalfEven;
use touchoff::Pose;

const BITS: usize = 256;

pub(super) type Big = FBig<HalfEven, 2>;

pub(super) fn big(value: f64) -> Big {
    Big::try_from(value).expect("a finite number").with_precision(BITS).value()
}

/// A rigid motion: three rows of a rotation and a translation.
#[derive(Clone)]
pub(super) struct Affine(pub(super) [[Big; 4]; 3]);

impl Affine {
    pub(super) fn translation(by: [f64; 3]) -> Affine {
        Affine([0, 1, 2].map(|row| {
            [0, 1, 2, 3].map(|column| match column {
                3 => big(by[row]),
                _ => big(if row == column { 1.0 } else { 0.0 }),
            })
        }))
    }

    /// Returns the motion with exactly the numbers of a pose.
    pub(super) fn of_pose(pose: &Pose) -> Affine {
        Affine([0, 1, 2].map(|row| {
            [0, 1, 2, 3].map(|column| match column {
                3 => big(pose.tip()[row]),
                _ => big(pose.rotation()[(row, column)]),
            })
        }))
    }

    /// Returns the rotation about a line: I + sin θ K + (1 − cos θ) K², with K the cross product by the
    /// direction.
    pub(super) fn turn(direction: [f64; 3], point: [f64; 3], degrees: f64) -> Affine {
        let d = direction.map(big);
        let norm = (&d[0] * &d[0] + &d[1] * &d[1] + &d[2] * &d[2]).sqrt();
        let [x, y, z] = d.map(|component| component / &norm);
        let zero = || big(0.0);
        let k = [[zero(), -&z, y.clone()], [z, zero(), -&x], [-y, x, zero()]];
        let (sine, cosine) = (big(degrees) * Big::pi(BITS) / big(180.0)).sin_cos();
        let versine = big(1.0) - cosine;
        let rotation = [0, 1, 2].map(|row| {
            [0, 1, 2].map(|column| {
                let square = (0..3).fold(zero(), |sum, at| sum + &k[row][at] * &k[at][column]);
                let identity = big(if row == column { 1.0 } else { 0.0 });
                identity + &sine * &k[row][column] + &versine * square
            })
        });
        let turn = Affine([0, 1, 2].map(|row| {
            let [a, b, c] = rotation[row].clone();
            [a, b, c, zero()]
        }));
        let back = Affine::translation(point.map(|component| -component));
        Affine::translation(point).then(&turn).then(&back)
    }

    /// Returns the product of both, which applies `inner` first.
    pub(super) fn then(&self, inner: &Affine) -> Affine {
        Affine([0, 1, 2].map(|row| {
            [0, 1, 2, 3].map(|column| {
                let last = if column == 3 { self.0[row][3].clone() } else { big(0.0) };
                (0..3).fold(last, |sum, at| sum + &self.0[row][at] * &inner.0[at][column])
            })
        }))
    }

    pub(super) fn inverse(&self) -> Affine {
        Affine([0, 1, 2].map(|row| {
            [0, 1, 2, 3].map(|column| match column {
                3 => (0..3).fold(big(0.0), |sum, at| sum - &self.0[at][row] * &self.0[at][3]),
                _ => self.0[column][row].clone(),
            })
        }))
    }
}

/// An axis of a file, with its numbers as they are written.
struct FileAxis {
    index: usize,
    is_table: bool,
    direction: [f64; 3],
    point: [f64; 3],
}

/// A machine's file.
pub(super) struct FileMachine(Vec<FileAxis>);

impl FileMachine {
    pub(super) fn parse(text: &str) -> FileMachine {
        let table: toml::Table = text.parse().expect("a table");
        let axes = table["axis"].as_array().expect("a list of axes");
        FileMachine(
            axes.iter()
                .map(|axis| {
                    let letter = axis["letter"].as_str().expect("a letter");
                    let index = "XYZABC".find(letter).expect("a letter of an axis");
                    let vector = |key: &str| {
                        let values = axis.get(key).and_then(|value| value.as_array());
                        values.map(|values| {
                            [0, 1, 2].map(|at| {
                                let value = &values[at];
                                value
                                    .as_float()
                                    .unwrap_or_else(|| value.as_integer().expect("a number") as f64)
                            })
                        })
                    };
                    let mut along = [0.0; 3];
                    along[index % 3] = 1.0;
                    FileAxis {
                        index,
                        is_table: axis["carries"].as_str() == Some("table"),
                        direction: vector("direction").unwrap_or(along),
                        point: vector("point").unwrap_or([0.0; 3]),
                    }
                })
                .collect(),
        )
    }

    pub(super) fn links(&self) -> usize {
        self.0.iter().filter(|axis| axis.is_table).count()
    }

    /// Returns J(q) of every axis.
    pub(super) fn motions(&self, joints: &[f64; 6]) -> Vec<Affine> {
        let motion = |axis: &FileAxis| match axis.index {
            0..3 => Affine::translation(axis.direction.map(|part| part * joints[axis.index])),
            _ => Affine::turn(axis.direction, axis.point, joints[axis.index]),
        };
        self.0.iter().map(motion).collect()
    }

    /// Returns the pose of the tip relative to a link: the inverse of the link's pose in machine coordinates,
    /// J(−q) of its axes, times that of the tip.
    pub(super) fn pose(&self, motions: &[Affine], length: f64, link: usize) -> Affine {
        let side = |is_table: bool| {
            self.0.iter().zip(motions).filter(move |(axis, _)| axis.is_table == is_table)
        };
        let identity = || Affine::translation([0.0; 3]);
        let body = side(true)
            .take(link)
            .fold(identity(), |pose, (_, motion)| pose.then(&motion.inverse()));
        let tool = side(false).fold(identity(), |pose, (_, motion)| pose.then(motion));
        body.inverse().then(&tool).then(&Affine::translation([0.0, 0.0, -length]))
    }

    /// Returns where the link that an axis moves is in machine coordinates, for the axis's index in [`FileMachine::motions`]; the
    /// base without one.
    pub(super) fn place(&self, motions: &[Affine], last: Option<usize>) -> Affine {
        let mut place = Affine::translation([0.0; 3]);
        let Some(last) = last else { return place };
        let axes = self.0.iter().zip(motions).take(last + 1);
        for (axis, motion) in axes.filter(|(axis, _)| axis.is_table == self.0[last].is_table) {
            place = match axis.is_table {
                true => place.then(&motion.inverse()),
                false => place.then(motion),
            };
        }
        place
    }

    /// Returns the frame of the workpiece in the last link: where the tip of a tool of length 0 is at the
    /// joint values of the work offset, if the rotary axes of the tool stay at 0.
    pub(super) fn workpiece(&self, offset: &[f64; 6]) -> Affine {
        let mut joints = *offset;
        for axis in self.0.iter().filter(|axis| !axis.is_table && axis.index >= 3) {
            joints[axis.index] = 0.0;
        }
        // The frame is parallel to machine coordinates at these joint values, as the tip's frame is.
        self.pose(&self.motions(&joints), 0.0, self.links())
    }
}
