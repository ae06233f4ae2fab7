//! The compiler: texts of tools, what is said about them, what they become and what is proved about them.

mod bad_input;
mod certificates;
mod compile_fail;
mod compile_pass;
mod drawings;
mod expressions;
mod generated;
mod language;
mod layers;
mod mounts;
mod profiles;
mod refused;
