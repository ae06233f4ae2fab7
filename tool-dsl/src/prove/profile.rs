//! The depth of a profile is the distance from it, by Theorem 2 of `docs/proofs.md`.

use crate::plan::{self, PlannedTool};

/// Returns the greatest difference of a profile's depth from the distance, in the file's unit, if it is proved from the
/// outline, the regions' depths and the tree alone.
pub(super) fn proved_deviation(tool: &PlannedTool) -> Option<f64> {
    let profile = tool.model.profile.as_ref()?;
    let (geometry, mut graph) = (profile.inner.section(), tool.model.graph.clone());
    for (index, region) in tool.model.regions.iter().enumerate() {
        // Equal expressions are one node, so this is the distance from the feature.
        if geometry.depth(&mut graph, profile.feature_of(index)) != Some(region.depth) {
            return None;
        }
    }
    plan::proved_deviation(&tool.model, &tool.tree)
}
