//! Jobs: built in code and read from the text of their files, what controls do differently, and the codes of what is found.
//!
//! Controls differ: a program on which they do is clean only if it is clean on all of them, or on the one that is named.

mod built;
mod codes;
mod empty_spindle;
mod five_axes;
mod folder;
mod holes_and_arcs;
mod in_the_way;
mod jobs;
mod left_open;
mod lengths;
mod machine_coordinates;
mod motions;
mod posts;
mod scene;
mod sentences;
mod tool_comments;
mod words;
