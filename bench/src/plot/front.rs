//! What nothing else beats.

/// The points that no other is below in both parts (Pareto's front), from left to right. Of equal
/// points one is kept; those that are not finite are on no front.
pub fn front(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut sorted: Vec<[f64; 2]> =
        points.iter().copied().filter(|p| p.iter().all(|c| c.is_finite())).collect();
    sorted.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let mut best = f64::INFINITY;
    sorted.retain(|[_, y]| {
        let better = *y < best;
        best = best.min(*y);
        better
    });
    sorted
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_front_is_what_nothing_beats() {
        let points = [[2.0, 2.0], [1.0, 5.0], [3.0, 2.0], [4.0, 1.0], [1.0, 6.0], [2.0, 2.0]];
        assert_eq!(front(&points), [[1.0, 5.0], [2.0, 2.0], [4.0, 1.0]]);
        assert_eq!(front(&[[f64::NAN, 0.0], [1.0, f64::INFINITY]]), [[0.0; 2]; 0]);
    }
}
