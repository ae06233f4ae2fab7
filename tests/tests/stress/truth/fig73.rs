//! The thesis's tool with its own magnitudes (Ho 1999, eq. 7.1 to 7.3), in 256 bits.

use super::{ExactPoint, RegionValues, Truth};
use touchoff::Tool;
use touchoff_tests::oracle::big::Big;
use touchoff_tests::oracle::reference::{QueryPoint, Reference};
use touchoff_tests::oracle::restated::Restated;

const NAMES: [&str; 9] = ["I", "II", "III", "IV", "V", "VI", "VII", "VIII", "IX"];

/// The true values of `Fig73`: its magnitude inside, and the distance from its solid outside.
pub(super) struct Magnitudes {
    solid: Reference,
    /// The thesis's index of each region in the tool info.
    indices: Vec<Option<usize>>,
}

impl Magnitudes {
    pub(super) fn new(tool: &dyn Tool, solid: &Restated) -> Magnitudes {
        let regions = tool.info().regions.iter();
        let index_of = |name: &str| NAMES.iter().position(|known| *known == name);
        Magnitudes {
            solid: Reference::new(solid),
            indices: regions.map(|region| index_of(&region.name)).collect(),
        }
    }
}

/// A point in the thesis's frame, whose z runs from the back of the housing to the tip.
struct ThesisPoint {
    d: Big,
    z: Big,
    radial: [Big; 2],
}

impl ThesisPoint {
    fn new([x, y, z]: &ExactPoint) -> ThesisPoint {
        let d = (&(x * x) + &(y * y)).sqrt();
        let radial =
            if d == Big::zero() { [Big::exactly(1.0), Big::zero()] } else { [x / &d, y / &d] };
        ThesisPoint { z: &Big::exactly(20.0) - z, d, radial }
    }

    /// Returns `a + b d + c z`.
    fn sum(&self, a: f64, b: f64, c: f64) -> Big {
        let term = |factor: f64, value: &Big| &Big::exactly(factor) * value;
        &(&Big::exactly(a) + &term(b, &self.d)) + &term(c, &self.z)
    }

    /// Returns the distance from the ball's centre, and the vector from there.
    fn arm(&self) -> (Big, [Big; 2]) {
        let dz = self.sum(-19.0, 0.0, 1.0);
        ((&(&self.d * &self.d) + &(&dz * &dz)).sqrt(), [self.d.clone(), dz])
    }

    fn magnitude(&self, region: usize) -> Big {
        match region {
            0 => self.z.clone(),
            1 => self.sum(5.0, -1.0, 0.0),
            2 => self.sum(11.0, 0.0, -1.0),
            3 => self.sum(14.0, -1.0, -1.0),
            4 => self.sum(3.0, -1.0, 0.0),
            5 => self.sum(16.0, -1.0, -1.0),
            6 => self.sum(17.0, -2.0, -1.0),
            7 => self.sum(1.0, -1.0, 0.0),
            _ => &Big::exactly(1.0) - &self.arm().0,
        }
    }

    /// Returns the largest violation of a region's conditions, or 0 inside the region.
    fn outside(&self, region: usize) -> Big {
        let s = |a, b, c| self.sum(a, b, c);
        let min = |a: Big, b: Big| if a < b { a } else { b };
        let violations: Vec<Big> = match region {
            0 => vec![-&s(0.0, 0.0, 1.0), s(-5.0, 1.0, 1.0)],
            1 => vec![
                s(-5.0, 1.0, 0.0),
                s(5.0, -1.0, -1.0),
                min(s(-9.0, 0.0, 1.0), s(-6.0, -1.0, 1.0)),
            ],
            2 => vec![s(3.0, -1.0, 0.0), s(6.0, 1.0, -1.0), s(-11.0, 0.0, 1.0)],
            3 => vec![s(-3.0, 1.0, 0.0), s(9.0, 0.0, -1.0), s(-11.0, 0.0, 1.0)],
            4 => vec![
                s(-3.0, 1.0, 0.0),
                s(11.0, 0.0, -1.0),
                min(s(-13.0, 0.0, 1.0), s(-14.0, 1.0, 1.0)),
            ],
            5 => vec![s(1.0, -1.0, 0.0), s(13.0, 0.0, -1.0), s(-16.0, 1.0, 1.0)],
            6 => vec![s(-1.0, 1.0, 0.0), s(14.0, -1.0, -1.0), s(-16.0, 1.0, 1.0)],
            7 => vec![s(-1.0, 1.0, 0.0), s(16.0, -1.0, -1.0), s(-19.0, 0.0, 1.0)],
            _ => vec![s(19.0, 0.0, -1.0), -&self.magnitude(8)],
        };
        violations
            .into_iter()
            .fold(Big::zero(), |max, violation| if violation > max { violation } else { max })
    }

    /// Returns the direction toward the surface by the thesis, in the tool's frame.
    fn direction(&self, region: usize) -> ExactPoint {
        let root = |n: f64| Big::exactly(n).sqrt();
        let one = || Big::exactly(1.0);
        let [e_d, e_z] = match region {
            0 => [Big::zero(), -&one()],
            1 | 4 | 7 => [one(), Big::zero()],
            2 => [Big::zero(), one()],
            3 | 5 => [&one() / &root(2.0), &one() / &root(2.0)],
            6 => [&Big::exactly(2.0) / &root(5.0), &one() / &root(5.0)],
            _ => match self.arm() {
                (length, _) if length == Big::zero() => [Big::zero(), -&one()],
                (length, [dd, dz]) => [&dd / &length, &dz / &length],
            },
        };
        [&e_d * &self.radial[0], &e_d * &self.radial[1], -&e_z]
    }
}

impl Truth for Magnitudes {
    fn scale(&self) -> f64 {
        self.solid.scale()
    }

    fn depth(&self, p: &ExactPoint) -> Big {
        let point = ThesisPoint::new(p);
        match (0..9).find(|region| point.outside(*region) == Big::zero()) {
            Some(region) => point.magnitude(region),
            None => -&self.solid.depth(&QueryPoint::of(p.clone())).abs(),
        }
    }

    fn owner(&self, p: &ExactPoint) -> Option<usize> {
        let point = ThesisPoint::new(p);
        let owner = (0..9).find(|region| point.outside(*region) == Big::zero())?;
        self.indices.iter().position(|index| *index == Some(owner))
    }

    fn region_values(&self, p: &ExactPoint, region: usize) -> Option<RegionValues> {
        let region = (*self.indices.get(region)?)?;
        let point = ThesisPoint::new(p);
        let d = point.d.to_f64();
        Some(RegionValues {
            depth: point.magnitude(region),
            excess_distance: point.outside(region).to_f64(),
            direction: point.direction(region),
            singularity_distance: match region {
                0 | 2 => f64::INFINITY,
                8 => d.min(point.arm().0.to_f64()),
                _ => d,
            },
        })
    }
}
