//! The compiler: texts of tools, their diagnostics, their code and their certificates.

mod api;
mod certificates;
mod compile_pass;
mod drawings;
mod generated;
mod mounts;
mod mutants;
mod profiles;
