//! The runtime: evaluators, queries, scenes, imported tools and the haptic loop.

mod closed_forms;
mod evaluators;
mod import;
mod levels;
mod query;
mod scene;
mod solids;
mod units;
