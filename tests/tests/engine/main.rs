//! The runtime: evaluators, queries, scenes and the haptic loop.

mod closed_forms;
mod evaluators;
mod haptic;
mod levels;
mod query;
mod scene;
mod solids;
mod units;
