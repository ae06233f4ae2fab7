//! Expressions as one shared graph: the only definition of the values that a tool computes.
//!
//! All statements about a tool are statements about this graph. The derivative ([`mod@derive`]) adds nodes to
//! it. Enclosures ([`interval`]) and values ([`value`]) are computed by walks over it. The emitted Rust and
//! the plan that the runtime evaluates are listings of it.
//!
//! # Meaning of a node
//!
//! A node denotes a partial function `f(x, y, z, u)`, real where it is defined. `x, y, z` is the point of
//! evaluation, in the tool's frame (the tip is the origin, `+z` points toward the spindle; a solid's frame is
//! its file's) and in the file's unit of length. `u > 0` is the length of the file's unit in units of the
//! part, which only [`Coord::Length`] and [`Coord::PerLength`] read. Operands precede their nodes: the
//! meaning is defined by induction over [`Id`]s.
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
//! Only [`derive`](mod@derive) and directions create a `Quotient`, for the derivative of a root at 0; the `/`
//! of a text is `Div`. Code for lanes computes both sides of a `Select`. A side may therefore be undefined
//! where it is not chosen, and no node may have a side effect or trap: all of them are IEEE operations that
//! return NaN or an infinity.
//!
//! # Computed values
//!
//! | walk | result | difference from the meaning |
//! |---|---|---|
//! | [`Evaluator`](value::Evaluator), emitted code, the runtime's plan | `f64`, one IEEE operation per node in the order of ids | one rounding per node and per constant; a partial function gives NaN or an infinity |
//! | [`Encloser`](interval::Encloser) | an interval that contains the value at every point of a box where the node is defined | none: ends are rounded outward |
//! | constants, [`Number`](crate::number::Number) | 256 bits, rounded half to even | `2^-256` relative per operation |
//!
//! `min(a, b)` and `max(a, b)` give `b` where the operands are equal or one is NaN, as vector instructions
//! do. This decides the sign of a zero, never a real value. A `Select` takes `other` where a comparison
//! involves NaN. No walk fuses a multiplication with an addition, and none calls a library function except
//! the square root, which IEEE rounds correctly. All walks over `f64` therefore have the same bits on every
//! machine.
//!
//! # Invariants
//!
//! [`Graph`]'s functions establish them, and there is no other way to add a node:
//!
//! 1. **Order.** An operand's id is less than its node's. A walk in the order of ids needs no recursion.
//! 2. **Sharing.** Equal nodes are one node: `a == b` for ids means that two expressions have the same form.
//!    Two expressions with different ids may still be the same function.
//! 3. **Normal form.** A node has the form that [`Graph`] states. A node whose operands are constants is a constant. Rewriting
//!    keeps the meaning wherever the expression is defined as it was written, and may define it elsewhere: `a / a` is 1 at a zero
//!    of `a`.
//! 4. **Radius.** `d · d` is `Q`, `√Q` is `D`, `x² + y²`, in this order, is `Q`: no root is computed where none is needed.
//! 5. **Height.** At most 300 operations lie between an expression of a text and a coordinate
//!    (`resolve::lower` refuses more), so a recursive walk does not exhaust the stack.
//! 6. **Aliases.** `Graph::add_proof_alias(a, b)` states that `a` and `b` are the same real function wherever both are
//!    defined. Code computes `a`, which rounds less; proofs read `b`, whose form they can use. The caller
//!    must derive the identity: `regionalise::nearer` is the only caller and has the derivation next to each
//!    statement.
//!
//! Nodes are only added. An [`Id`] stays valid, and keeps its meaning, for the lifetime of its graph.

pub(crate) mod corner;
pub mod derive;
mod graph;
pub mod interval;
pub mod polynomial;
#[cfg(test)]
mod tests;
pub mod value;

pub(crate) use graph::EvaluationOrders;
pub use graph::Graph;
pub use graph::{Coord, Id, Node};
