//! The model of a tool with a profile.

use crate::certify::tool_model::chains::Chain;
use crate::certify::tool_model::peaks::Peaks;
use crate::certify::tool_model::section::Section;
use crate::tool::ToolInfo;

/// The section of a tool, with what bounds and searches take from it.
#[derive(Clone, Debug)]
pub(crate) struct ProfileModel {
    pub(crate) section: Section,
    /// All slabs in chains, for bounds that need not be tight.
    pub(crate) chains: Vec<Chain>,
    /// The circles about the axis on which depth can be greatest in a triangle.
    pub(crate) circles: Peaks,
}

impl ProfileModel {
    /// Creates the model of a tool; `error` is the error bound of a point. Returns `None` if the tool has no profile, or one that
    /// bounds nothing.
    pub(crate) fn new(info: &ToolInfo, error: f64) -> Option<ProfileModel> {
        let section = Section::new(info, error)?;
        Some(ProfileModel { chains: section.chains(), circles: section.circles(), section })
    }
}
