//! The runtime: evaluators, queries, scenes and tools in other units.

mod closed_forms;
mod evaluators;
mod levels;
mod query;
mod scene;
mod scene_sums;
mod solids;
mod units;
