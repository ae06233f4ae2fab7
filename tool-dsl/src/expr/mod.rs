//! Expressions as one shared graph: the single statement of what a tool computes.
//!
//! All statements about a tool are statements about this graph. The derivative ([`mod@derive`]) is more of it. An
//! enclosure ([`interval`]) and a value ([`value`]) are walks over it. The emitted Rust and the interpreter's tape are
//! listings of it.
//!
//! # What a node means
//!
//! A node means a partial function `f(x, y, z, u)`, real where it is defined. `x, y, z` is the point that is evaluated,
//! in the tool's frame (the tip is the origin, `+z` points toward the spindle; a solid's frame is its file's) and in the
//! file's unit of length. `u > 0` is the length of the file's unit in units of the part, which only
//! [`Coord::Length`] and [`Coord::PerLength`] read. Operands come first: the meaning is defined by induction over
//! [`Id`]s.
//!
//! | node | meaning | defined |
//! |---|---|---|
//! | `Const(c)` | `c`, a number of 256 bits | everywhere |
//! | `Coord(X)`, `Y`, `Z` | the coordinate | everywhere |
//! | `Coord(D)` | `√(x² + y²)` | everywhere |
//! | `Coord(Q)` | `x² + y²` | everywhere |
//! | `Coord(Length)`, `PerLength` | `u`, `1/u` | everywhere |
//! | `Neg`, `Add`, `Sub`, `Mul`, `Abs` | the operation | where the operands are |
//! | `Min`, `Max` | the smaller, the larger | where the operands are |
//! | `Div(a, b)` | `a / b` | where the operands are and `b ≠ 0` |
//! | `Quotient(a, b)` | `a / b`, and 0 where `b = 0` | where the operands are |
//! | `Sqrt(a)` | `√a` | where `a ≥ 0` |
//! | `Select { low, high, then, other }` | `then` where `low ≤ high`, else `other` | where `low`, `high` and the chosen side are |
//!
//! `Quotient` is written by [`derive`](mod@derive) and by directions only, for the derivative of a root at 0; a text's
//! `/` is `Div`. Both sides of a `Select` are computed in code for lanes. So a side may be undefined where it is not
//! chosen, and no node may have an effect or a trap: all of them are IEEE operations that return NaN or an infinity.
//!
//! # What a value is
//!
//! | walk | gives | differs from the meaning by |
//! |---|---|---|
//! | [`Evaluator`](value::Evaluator), emitted code, tape | `f64`, one IEEE operation for a node in the order of ids | one rounding for a node and for a constant; a partial function gives NaN or an infinity |
//! | [`Encloser`](interval::Encloser) | an interval that holds the value at every point of a box where the node is defined | nothing: ends are rounded outward |
//! | constants, [`Number`](crate::number::Number) | 256 bits, rounded half to even | `2^-256` relative for an operation |
//!
//! `min(a, b)` and `max(a, b)` give `b` where the operands are equal or one is NaN, as vector instructions do: this
//! decides the sign of a zero, never a real value. A `Select` takes `other` where a comparison meets NaN. No walk
//! fuses a multiplication with an addition, and none calls a function of a library but the square root, which IEEE
//! rounds correctly. So all walks over `f64` have the same bits on every machine.
//!
//! # Invariants
//!
//! [`Graph`]'s functions establish them, and there is no other way to add a node:
//!
//! 1. **Order.** An operand's id is less than its node's. A walk in the order of ids needs no recursion.
//! 2. **Sharing.** Equal nodes are one node: `a == b` for ids says that two expressions are written alike, and two
//!    expressions with different ids may still be the same function.
//! 3. **Folding.** A node whose operands are constants is a constant; `0 + a`, `1 · a`, `a - a`, `a / a` and a double
//!    negation do not exist. Constants move outward through sums and products, so that the frame's shift and a text's
//!    numbers meet in 256 bits and are rounded once. Folding keeps the meaning wherever the unfolded expression is
//!    defined, and may define it where it was not: `a / a` is 1 at a zero of `a`.
//! 4. **Radius.** `d · d` is `Q`, `√Q` is `D`, `x² + y²` is `Q`: what needs no root has none.
//! 5. **Height.** At most 300 operations lie between an expression of a text and a coordinate (`resolve::lower` refuses
//!    more), so a walk that recurses does not exhaust the stack.
//! 6. **Aliases.** `Graph::also(a, b)` states that `a` and `b` are the same real function wherever both are defined.
//!    Code computes `a`, which rounds less; proofs read `b`, whose form they know. Whoever states it owes the
//!    derivation: `regionalise::nearer` is the only one, and has it beside each statement.
//!
//! Nodes are only added. An [`Id`] stays valid, and keeps its meaning, as long as its graph lives.

pub mod derive;
mod graph;
pub mod interval;
mod node;
pub mod polynomial;
pub mod value;

pub use graph::Graph;
pub use node::{Coord, Id, Node};
