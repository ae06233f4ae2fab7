//! The runtime: evaluators, queries, scenes and tools in other units.

mod closed_forms;
mod evaluators;
mod levels;
mod posture;
mod prelude;
mod query;
mod reach;
mod scene;
mod scene_sums;
mod solids;
mod units;
