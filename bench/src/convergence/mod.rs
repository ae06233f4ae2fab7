//! How what is felt of a cloud nears what is felt of the surface, as the cloud gets denser.
//!
//! [`errors`] has contacts that are known in closed form ([`contact`]), [`missed`] how often a shallow
//! one is not noticed at all, [`bounds`] what the covering radius promises, [`cover`] how large it is.

pub mod bounds;
pub mod contact;
pub mod cover;
pub mod errors;
pub mod missed;
pub mod page;
pub mod plots;
mod verdict;

use touchoff::{Cloud, Mesh};

/// How points are spread.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pattern {
    /// Independently of each other: [`Cloud::random`].
    Random,
    /// Evenly: [`Cloud::blue`].
    Blue,
}

impl Pattern {
    /// Both, in the order of tables.
    pub const ALL: [Pattern; 2] = [Pattern::Random, Pattern::Blue];

    /// The word for it.
    pub fn name(self) -> &'static str {
        match self {
            Pattern::Random => "random",
            Pattern::Blue => "blue",
        }
    }

    /// A cloud whose weights are the areas of its cells, with its covering radius.
    ///
    /// # Panics
    /// If there are no points, or too many.
    pub fn cloud(self, mesh: &Mesh, count: usize, seed: u64) -> Cloud {
        const COUNT: &str = "a count that 32 bits hold";
        match self {
            Pattern::Random => Cloud::random(mesh, count, seed).expect(COUNT).weighed(mesh),
            Pattern::Blue => Cloud::blue(mesh, count, seed).expect(COUNT),
        }
    }
}

/// For how much a point counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Weighing {
    /// For as much as every other: the area over the number of points.
    Equal,
    /// For the area of its cell.
    Cells,
}

/// The same points, each for as much as every other.
///
/// # Panics
/// Never: what a cloud gives makes one.
pub fn equal(cloud: &Cloud, mesh: &Mesh) -> Cloud {
    let weights = vec![mesh.survey().area / cloud.len() as f64; cloud.len()];
    let (points, normals) = (cloud.points().to_vec(), cloud.normals().to_vec());
    let triangles = cloud.triangles().to_vec();
    Cloud::new(points, normals, triangles, weights, cloud.unit()).expect("the lists of a cloud")
}

/// The covering radius of a cloud, which has to be proved.
///
/// # Panics
/// If it is not known or not proved.
pub fn radius(cloud: &Cloud) -> f64 {
    let cover = cloud.cover().expect("a cloud of a mesh has a cover");
    assert!(cover.proved, "of a mesh it is proved");
    cover.radius
}

/// The order p of `y = c x^p`, and the logarithm of c, by least squares of the logarithms.
pub fn order(points: &[[f64; 2]]) -> [f64; 2] {
    let logs = points.iter().map(|[x, y]| [x.ln(), y.ln()]).collect::<Vec<_>>();
    let mean = |axis: usize| logs.iter().map(|p| p[axis]).sum::<f64>() / logs.len() as f64;
    let [x, y] = [mean(0), mean(1)];
    let along: f64 = logs.iter().map(|p| (p[0] - x) * (p[1] - y)).sum();
    let across: f64 = logs.iter().map(|p| (p[0] - x) * (p[0] - x)).sum();
    let slope = along / across;
    [slope, y - slope * x]
}

/// The root of the mean of squares.
pub fn rms(values: impl IntoIterator<Item = f64>) -> f64 {
    let (mut sum, mut count) = (0.0, 0);
    for value in values {
        sum += value * value;
        count += 1;
    }
    (sum / f64::from(count.max(1))).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_power_is_found_again() {
        let [slope, log] = order(&[1.0, 10.0, 400.0].map(|x: f64| [x, 3.0 * x.powf(-1.26)]));
        assert!((slope + 1.26).abs() < 1e-12 && (log - 3f64.ln()).abs() < 1e-12);
        assert!((rms([3.0, 4.0]) - 12.5f64.sqrt()).abs() < 1e-15);
    }
}
