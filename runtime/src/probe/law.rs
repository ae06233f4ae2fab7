//! The force laws of contacts.

use crate::keywords::keyword_enum;

/// The force on the tool as a function of a contact's magnitude. `m` is the magnitude, `w` the weight, `n` the part's
/// outward normal, `u` the direction to the tool's nearest surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Law {
    /// `w m (n − u)` (Ho 1999, eq. 5.1, without the factor ½). Not conservative.
    #[default]
    Thesis,
    /// `w m ∇m`, the gradient of the energy `½ Σ w m²`: conservative.
    Gradient,
    /// The law `Thesis` without points whose normal faces away (`u · n > 0`), for thin sheets.
    Facing,
}

/// The weight of a point.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Weights {
    /// The point's share of the surface: forces converge as the cloud gets denser.
    #[default]
    Area,
    /// 1 for every point, as in the thesis: forces grow with the density.
    Unit,
}

keyword_enum!(Law, "thesis, gradient, facing", Thesis "thesis", Gradient "gradient", Facing "facing");
keyword_enum!(Weights, "area, unit", Area "area", Unit "unit");
