//! Evaluations of a tool at points, read one by one, and the SIMD levels at which they are made.

use touchoff::Level;
use touchoff::tool::{Evaluations, Outputs, PointBatch, PointEvaluation, Tool};
use touchoff_dsl::interpret::Evaluation;

/// Returns points as evaluators take them.
pub fn batch(points: &[[f64; 3]]) -> PointBatch {
    let mut batch = PointBatch::default();
    points.iter().for_each(|p| batch.push(*p));
    batch
}

/// Returns whether the point with an index is inside.
pub fn is_inside(evaluations: &Evaluations, index: usize) -> bool {
    evaluations.inside[index / 8] >> (index % 8) & 1 == 1
}

/// Returns all outputs at the point with an index; `None` outside.
pub fn at(evaluations: &Evaluations, index: usize) -> Option<PointEvaluation> {
    is_inside(evaluations, index).then(|| PointEvaluation {
        region: evaluations.region[index] as usize,
        depth: evaluations.depth[index],
        magnitude: evaluations.magnitude[index],
        niceness: evaluations.niceness[index],
        direction: [0, 1, 2].map(|axis| evaluations.direction[axis][index]),
        gradient: [0, 1, 2].map(|axis| evaluations.gradient[axis][index]),
    })
}

/// Evaluates a tool at points, at a SIMD level, in the file's unit; `None` for points outside.
pub fn evaluate_points(
    tool: &dyn Tool,
    level: Level,
    points: &[[f64; 3]],
) -> Vec<Option<PointEvaluation>> {
    let mut evaluations = Evaluations::default();
    tool.evaluate(level, Outputs::EVERYTHING, &batch(points), 1.0, &mut evaluations);
    (0..points.len()).map(|index| at(&evaluations, index)).collect()
}

/// Returns an evaluation of the reference interpreter as others give it.
pub fn of_reference(evaluation: Evaluation) -> PointEvaluation {
    let Evaluation { region, depth, magnitude, direction, gradient, niceness } = evaluation;
    PointEvaluation { region, depth, magnitude, direction, gradient, niceness }
}

/// Returns all numbers of an evaluation.
pub fn numbers(evaluation: &PointEvaluation) -> [f64; 9] {
    let ([ux, uy, uz], [gx, gy, gz]) = (evaluation.direction, evaluation.gradient);
    let PointEvaluation { depth, magnitude, niceness, .. } = *evaluation;
    [depth, magnitude, niceness, ux, uy, uz, gx, gy, gz]
}

/// Returns the region of an evaluation, and the bits of all numbers.
pub fn bits(evaluation: &PointEvaluation) -> (usize, [u64; 9]) {
    (evaluation.region, numbers(evaluation).map(f64::to_bits))
}

/// Returns every SIMD level of this machine with its name, the best of them first and again under its own name.
pub fn levels() -> Vec<(&'static str, Level)> {
    let best = Level::new();
    let mut levels = vec![("best", best), ("baseline", Level::baseline())];
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    {
        levels.extend(best.as_sse2().map(|token| ("SSE2", Level::Sse2(token))));
        levels.extend(best.as_sse4_2().map(|token| ("SSE4.2", Level::Sse4_2(token))));
        levels.extend(best.as_avx2().map(|token| ("AVX2", Level::Avx2(token))));
        levels.extend(best.as_avx512().map(|token| ("AVX-512", Level::Avx512(token))));
    }
    levels
}
