//! Features of packages of others.
//!
//! Cargo compiles a package of others once per set of features, and a set depends on what is built: the workspace, or one of its packages. Each
//! package of this repository has this one for its tests, which asks for all features that any of them asks for, for programs and for macros alike.
//! A test of one package thus finds compiled what the tests of the workspace have compiled. `scripts/features` lists where that is not so.
