//! The compiler: texts of tools, their diagnostics, their code and their certificates.

mod api;
mod bad_input;
mod certificates;
mod compile_pass;
mod drawings;
mod expressions;
mod generated;
mod language;
mod mounts;
mod mutants;
mod profiles;
mod refused;
