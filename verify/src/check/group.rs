//! Findings of consecutive motions, joined.

use super::{Finding, FindingKind};
use std::cmp::Ordering;
use std::mem::{self, Discriminant};
use touchoff::SurfaceId;

/// Findings of the same kind and surface in consecutive motions.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct FindingGroup {
    /// The finding of the first motion.
    pub first: Finding,
    /// The worst finding: the deepest, or the nearest. Its bound holds for all motions of the group.
    pub worst: Finding,
    /// The finding of the last motion.
    pub last: Finding,
    /// Number of blocks or cutter locations.
    pub motions: usize,
}

impl FindingGroup {
    /// Joins findings in the program's order. Groups come in order of their first motion.
    pub fn join(findings: &[Finding]) -> Vec<FindingGroup> {
        let mut groups: Vec<FindingGroup> = Vec::new();
        // The groups that the next motion may continue; a tool has few surfaces.
        let mut open: Vec<(Key, usize)> = Vec::new();
        for finding in findings {
            let key = (finding.kind.surface(), mem::discriminant(&finding.kind));
            let position = open.iter().position(|(known, _)| *known == key);
            if let Some(position) = position {
                let group = &mut groups[open[position].1];
                if finding.location <= group.last.location + 1 {
                    group.add(finding);
                    continue;
                }
                open.swap_remove(position);
            }
            open.push((key, groups.len()));
            groups.push(FindingGroup {
                first: *finding,
                worst: *finding,
                last: *finding,
                motions: 1,
            });
        }
        groups
    }

    fn add(&mut self, finding: &Finding) {
        // A block may have several moves, and a first position by itself.
        self.motions += usize::from(finding.line != self.last.line);
        self.last = *finding;
        let other = if finding.kind.severity(&self.worst.kind) == Ordering::Greater {
            mem::replace(&mut self.worst, *finding)
        } else {
            *finding
        };
        self.worst.kind.include_bound(&other.kind);
    }
}

/// The surface and the kind of a finding.
type Key = (Option<SurfaceId>, Discriminant<FindingKind>);

impl FindingKind {
    /// Extends the bound over the motion to that of another finding of the same kind.
    pub(super) fn include_bound(&mut self, other: &FindingKind) {
        match (self, other) {
            (FindingKind::Deep { max_depth, .. }, FindingKind::Deep { max_depth: other, .. }) => {
                *max_depth = max_depth.max(*other);
            }
            (
                FindingKind::Near { min_distance, .. },
                FindingKind::Near { min_distance: other, .. },
            ) => *min_distance = min_distance.min(*other),
            _ => (),
        }
    }

    /// Compares findings by severity: a tool or a surface inside the material, then depth beyond the allowance, then
    /// distance short of the margin, then motions that could not be decided.
    pub fn severity(&self, other: &FindingKind) -> Ordering {
        let [one, other] = [self, other].map(|kind| match kind {
            FindingKind::Inside { surface: None } => (5, 0.0),
            FindingKind::Inside { surface: Some(_) } => (4, 0.0),
            FindingKind::Deep { allowed, depth, through, .. } => {
                (3, if *through { f64::INFINITY } else { depth.low - allowed })
            }
            FindingKind::Near { margin, distance, .. } => (2, margin - distance.high),
            FindingKind::Ambiguous(_) => (1, 0.0),
            FindingKind::Undecided { .. } => (0, 0.0),
        });
        one.0.cmp(&other.0).then(one.1.total_cmp(&other.1))
    }
}
