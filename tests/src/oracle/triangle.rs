//! Points of triangles in space.

use super::vector::{add, dot, norm, sub, vector_product};

/// A point in space.
pub type Point = [f64; 3];

/// Returns the weighted mean of a triangle's corners.
pub fn mean([a, b, c]: &[Point; 3], [u, v, w]: Point) -> Point {
    [0, 1, 2].map(|k| (u * a[k] + v * b[k] + w * c[k]) / (u + v + w))
}

/// Returns the point of a triangle with two barycentric weights.
pub fn point([a, b, c]: &[Point; 3], [v, w]: [f64; 2]) -> Point {
    add(&add(a, &sub(b, a), &v), &sub(c, a), &w)
}

/// Returns the point of a triangle nearest to `p`.
pub fn nearest(p: Point, corners: &[Point; 3]) -> Point {
    mean(corners, nearest_weights(p, corners))
}

/// Returns the weights of the point of a triangle that is approximately nearest to `p`. Candidates are the foot on the
/// plane, if it is inside, and the feet on the edges, since the plane of a sliver is poorly conditioned.
pub fn nearest_weights(p: Point, corners: &[Point; 3]) -> Point {
    let squared_distance = |weights: &Point| {
        let difference = sub(&p, &mean(corners, *weights));
        dot(&difference, &difference)
    };
    let edges = [[0, 1], [1, 2], [2, 0]].map(|[from, to]| {
        let edge = sub(&corners[to], &corners[from]);
        let fraction = dot(&sub(&p, &corners[from]), &edge) / dot(&edge, &edge);
        // This form maps NaN to 0, so an edge without length gives its first end.
        let fraction = if fraction > 0.0 { fraction.min(1.0) } else { 0.0 };
        let mut weights = [0.0; 3];
        weights[from] = 1.0 - fraction;
        weights[to] = fraction;
        weights
    });
    // The edges at the corner opposite the longest one determine the plane of a sliver best.
    let squared_opposite_edge = |k: &usize| {
        let edge = sub(&corners[(k + 1) % 3], &corners[(k + 2) % 3]);
        dot(&edge, &edge)
    };
    let origin = (0..3)
        .max_by(|j, k| squared_opposite_edge(j).total_cmp(&squared_opposite_edge(k)))
        .unwrap_or(0);
    let others = [(origin + 1) % 3, (origin + 2) % 3];
    let [e, f] = others.map(|k| sub(&corners[k], &corners[origin]));
    let (ee, ef, ff) = (dot(&e, &e), dot(&e, &f), dot(&f, &f));
    let area = ee * ff - ef * ef;
    // Iterative refinement: the first weights of a sliver have few correct digits.
    let mut weights = [0.0; 3];
    weights[origin] = 1.0;
    for _ in 0..3 {
        let residual = sub(&p, &mean(corners, weights));
        let (of_e, of_f) = (dot(&e, &residual), dot(&f, &residual));
        weights[others[0]] += (ff * of_e - ef * of_f) / area;
        weights[others[1]] += (ee * of_f - ef * of_e) / area;
        weights[origin] = 1.0 - weights[others[0]] - weights[others[1]];
    }
    let inside = weights.iter().all(|weight| *weight >= 0.0).then_some(weights);
    let candidates = edges.into_iter().chain(inside);
    candidates
        .min_by(|a, b| squared_distance(a).total_cmp(&squared_distance(b)))
        .unwrap_or([1.0, 0.0, 0.0])
}

/// Bisects a triangle at its longest edge, whatever its corners are.
pub fn bisected<P: Copy>(
    corners: [P; 3],
    distance: impl Fn(P, P) -> f64,
    midpoint: impl Fn(P, P) -> P,
) -> [[P; 3]; 2] {
    let length = |k: &usize| distance(corners[*k], corners[(k + 1) % 3]);
    let longest = (0..3).max_by(|j, k| length(j).total_cmp(&length(k))).unwrap_or(0);
    let [a, b, c] = [0, 1, 2].map(|k| corners[(longest + k) % 3]);
    let middle = midpoint(a, b);
    [[a, middle, c], [middle, b, c]]
}

/// Returns the winding number of a surface about a point: the sum of its triangles' solid angles (Van Oosterom,
/// Strackee 1983) over 4π.
pub fn winding_number(triangles: impl Iterator<Item = [Point; 3]>, point: Point) -> f64 {
    let angle = |corners: [Point; 3]| {
        let [a, b, c] = corners.map(|corner| sub(&corner, &point));
        let [x, y, z] = [&a, &b, &c].map(norm);
        let denominator = x * y * z + dot(&a, &b) * z + dot(&b, &c) * x + dot(&c, &a) * y;
        2.0 * dot(&a, &vector_product(&b, &c)).atan2(denominator)
    };
    triangles.map(angle).sum::<f64>() / (4.0 * std::f64::consts::PI)
}

#[cfg(test)]
mod tests {
    use super::super::rng::Rng;
    use super::super::vector::distance;
    use super::*;

    /// No other point of the triangle is nearer, of slivers and degenerate triangles too.
    #[test]
    fn no_other_point_is_nearer() {
        let mut rng = Rng::new(4);
        for height in [1.0, 1e-6, 1e-12, 0.0] {
            for _ in 0..300 {
                let [a, b, p] = [0; 3].map(|_| [0; 3].map(|_| rng.between(-1.0, 1.0)));
                let beside = add(&a, &sub(&b, &a), &rng.between(-0.5, 1.5));
                let c = add(&beside, &rng.direction(), &height);
                let least = distance(&p, &nearest(p, &[a, b, c]));
                for _ in 0..200 {
                    let other = distance(&p, &point(&[a, b, c], rng.weights()));
                    assert!(least <= other + 1e-14, "{a:?} {b:?} {c:?} {p:?}: {least} {other}");
                }
            }
        }
    }
}
