//! The names of a tool's regions and surfaces, against its restatement.

use crate::prelude::*;
use touchoff_tests::oracle::Nearest;

/// Compares a tool's info with the regions that a restated profile should have.
pub(crate) fn of(tool: &dyn Tool, oracle: &Nearest) {
    let info = tool.info();
    if !info.is_exact() {
        // Regions written by hand have an order and names of their own.
        return;
    }
    let actual: Vec<(&str, &str, bool)> = info
        .regions
        .iter()
        .map(|region| {
            let surface = &info.surfaces[region.surface.0];
            (&*region.name, &*surface.name, surface.cutting)
        })
        .collect();
    let regions = oracle.regions().into_iter().zip(oracle.surfaces());
    let expected: Vec<_> = regions.map(|(name, (surface, cuts))| (name, surface, cuts)).collect();
    assert_eq!(actual, expected);
    let [radius, height] = oracle.extent();
    let reach = info.envelope.iter().map(|slab| slab.radius).fold(0.0, f64::max);
    let top = info.envelope.iter().map(|slab| slab.high).fold(0.0, f64::max);
    assert!((reach - radius).abs() <= 1e-2 * radius && (top - height).abs() <= 1e-2 * height);
}
