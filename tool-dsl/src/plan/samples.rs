//! Points of the section with known owners, and the information that curves give about them.

use super::{BITS_PER_ADDITION, bits};
use crate::formula::CurveIndex;
use crate::geometry::function::CurveFunction;
use crate::geometry::outline::Point;
use crate::geometry::polygon::range;

/// The least cost, in additions, of a side on which several owners remain.
const MIN_SIDE_COST: f64 = 8.0;
/// The gain of a curve with all samples on one side of it, in bits: the cost of a side.
pub(super) const ONE_SIDED_GAIN: f64 = -BITS_PER_ADDITION * MIN_SIDE_COST;
/// The penalty, in bits, for each owner that remains on both sides. Without it, trees grow by half.
const SHARED_OWNER_PENALTY_BITS: f64 = 0.2;

/// A point with its owner, and the weight of its surroundings.
pub(super) struct Sample {
    pub(super) point: Point,
    pub(super) weight: f64,
    pub(super) owner: Option<usize>,
}

impl Sample {
    /// Makes a sample of a point and its weight.
    pub(super) fn new((point, weight): (Point, f64), owner: Option<usize>) -> Sample {
        Sample { point, weight, owner }
    }
}

/// All samples, in words of up to 64 with the same owner.
pub(super) struct Samples {
    owners: Vec<usize>,
    weights: Vec<Vec<f64>>,
    /// For each curve, a bit per sample that is below it.
    below: Vec<Vec<u64>>,
    /// An upper limit of the owners' indices.
    count: usize,
}

/// Some samples of a word, given by the word's index and their bits.
#[derive(Clone, Copy)]
struct WordPart {
    word: usize,
    bits: u64,
    /// The sum of their weights.
    weight: f64,
}

/// A subset of the samples.
#[derive(Default)]
pub(super) struct SampleSubset(Vec<WordPart>);

impl Samples {
    pub(super) fn new(all: &[Sample], shapes: &[CurveFunction<'_>]) -> Samples {
        let runs: Vec<&[Sample]> =
            all.chunk_by(|a, b| a.owner == b.owner).flat_map(|run| run.chunks(64)).collect();
        let owners: Vec<usize> =
            runs.iter().map(|run| run[0].owner.map_or(0, |owner| owner + 1)).collect();
        let words: Vec<Word<'_>> = runs.iter().map(|run| Word::new(run)).collect();
        Samples {
            count: owners.iter().max().map_or(1, |largest| largest + 1),
            weights: runs
                .iter()
                .map(|run| run.iter().map(|sample| sample.weight).collect())
                .collect(),
            below: shapes
                .iter()
                .map(|shape| words.iter().map(|word| word.bits_below(shape)).collect())
                .collect(),
            owners,
        }
    }

    pub(super) fn all(&self) -> SampleSubset {
        let words = self.weights.iter().enumerate().map(|(word, weights)| WordPart {
            word,
            bits: u64::MAX >> (64 - weights.len()),
            weight: weights.iter().sum(),
        });
        SampleSubset(words.collect())
    }

    /// Returns the samples below a curve, and those above.
    pub(super) fn divided(&self, subset: &SampleSubset, curve: CurveIndex) -> [SampleSubset; 2] {
        let mut sides = [SampleSubset::default(), SampleSubset::default()];
        for part in &subset.0 {
            for (side, half) in sides.iter_mut().zip(self.sides(*part, curve)) {
                if half.bits != 0 {
                    side.0.push(half);
                }
            }
        }
        sides
    }

    /// Returns the samples that are below a curve, and those above.
    fn sides(&self, part: WordPart, curve: CurveIndex) -> [WordPart; 2] {
        let none = WordPart { bits: 0, weight: 0.0, ..part };
        let below = part.bits & self.below[curve][part.word];
        // The weight of a whole part is known.
        if below == part.bits {
            return [part, none];
        }
        if below == 0 {
            return [none, part];
        }
        [below, part.bits & !below].map(|bits| WordPart {
            bits,
            weight: self.weight(part.word, bits),
            ..part
        })
    }

    fn weight(&self, word: usize, mut bits: u64) -> f64 {
        let mut sum = 0.0;
        while bits != 0 {
            sum += self.weights[word][bits.trailing_zeros() as usize];
            bits &= bits - 1;
        }
        sum
    }

    /// Returns the entropy of the owner of a sample, in bits.
    pub(super) fn entropy(&self, subset: &SampleSubset) -> f64 {
        let mut counts = vec![0.0; self.count];
        for part in &subset.0 {
            counts[self.owners[part.word]] += part.weight;
        }
        let total: f64 = counts.iter().sum();
        counts.iter().map(|count| bits(*count, total)).sum::<f64>() / total.max(f64::MIN_POSITIVE)
    }

    /// Returns the information, in bits, that a curve's side gives about the owners of some samples of the
    /// given `entropy`, less the cost of the tests that remain. Returns `None` if all samples are on one side.
    pub(super) fn gain(
        &self,
        subset: &SampleSubset,
        entropy: f64,
        curve: CurveIndex,
    ) -> Option<f64> {
        let mut counts = vec![[0.0; 2]; self.count];
        let mut totals = [0.0; 2];
        let (owners, below) = (&self.owners[..], &self.below[curve][..]);
        for part in &subset.0 {
            let count = &mut counts[owners[part.word]];
            let bits = part.bits & below[part.word];
            // The weight of a whole part is known.
            if bits == part.bits {
                count[0] += part.weight;
                totals[0] += part.weight;
            } else if bits == 0 {
                count[1] += part.weight;
                totals[1] += part.weight;
            } else {
                let (low, high) =
                    (self.weight(part.word, bits), self.weight(part.word, part.bits & !bits));
                *count = [count[0] + low, count[1] + high];
                totals = [totals[0] + low, totals[1] + high];
            }
        }
        if totals[0] == 0.0 || totals[1] == 0.0 {
            return None;
        }
        let (mut owners, mut penalty, mut remaining_bits) = ([0, 0], 0.0, 0.0);
        for [below, above] in counts {
            if below > 0.0 {
                owners[0] += 1;
                remaining_bits += bits(below, totals[0]);
            }
            if above > 0.0 {
                owners[1] += 1;
                remaining_bits += bits(above, totals[1]);
            }
            if below > 0.0 && above > 0.0 {
                penalty += SHARED_OWNER_PENALTY_BITS;
            }
        }
        let side_cost =
            owners.map(|owners| if owners > 1 { BITS_PER_ADDITION * MIN_SIDE_COST } else { 0.0 });
        Some(
            entropy
                - remaining_bits / (totals[0] + totals[1])
                - side_cost[0]
                - side_cost[1]
                - penalty,
        )
    }
}

/// Up to 64 samples, and the corners of the rectangle about them.
struct Word<'s> {
    samples: &'s [Sample],
    corners: [Point; 4],
}

impl<'s> Word<'s> {
    fn new(samples: &'s [Sample]) -> Word<'s> {
        let [[left, right], [low, high]] =
            [0, 1].map(|axis| range(samples.iter().map(|sample| sample.point[axis])));
        Word { samples, corners: [[left, low], [right, low], [left, high], [right, high]] }
    }

    /// Returns a bit for each sample that is below a curve.
    fn bits_below(&self, shape: &CurveFunction<'_>) -> u64 {
        // A line's values in a rectangle are extreme at corners, also when every operation is rounded.
        if shape.is_line() {
            let [first, others @ ..] = self.corners.map(|corner| shape.below(corner));
            if others == [first; 3] {
                return if first { u64::MAX >> (64 - self.samples.len()) } else { 0 };
            }
        }
        let mut bits = 0;
        for (k, sample) in self.samples.iter().enumerate() {
            bits |= u64::from(shape.below(sample.point)) << k;
        }
        bits
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lines beside a word, across it, and through its samples, which are on a circle.
    #[test]
    fn corners_tell_the_side_of_a_line_as_samples_do() {
        let turned = |k: u32| f64::from(k).sin_cos();
        let sample = |k: u32| {
            let (sine, cosine) = turned(k);
            Sample::new(([7.3 + 0.1 * cosine, 0.1 * sine], 1.0), None)
        };
        let samples: Vec<Sample> = (0..50).map(sample).collect();
        let word = Word::new(&samples);
        let (mut undivided, mut divided) = (0, 0);
        for k in 0..3000 {
            let (sine, cosine) = turned(k * 7);
            let Sample { point, .. } = samples[k as usize % samples.len()];
            let shift = [0.0, 1e-17, 0.05, 0.3][k as usize % 4];
            let middle = [point[0] + shift * cosine, point[1] + shift * sine];
            let shape = CurveFunction::Line { middle, constant: 0.0, slope: [cosine, sine] };
            let below = samples.iter().map(|sample| u64::from(shape.below(sample.point)));
            let expected = below.enumerate().fold(0, |bits, (k, bit)| bits | bit << k);
            assert_eq!(word.bits_below(&shape), expected, "{k}");
            let all = u64::MAX >> (64 - samples.len());
            *(if [0, all].contains(&expected) { &mut undivided } else { &mut divided }) += 1;
        }
        assert!(undivided > 500 && divided > 500, "{undivided} {divided}");
    }
}
