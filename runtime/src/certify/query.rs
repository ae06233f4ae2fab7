//! Queries for the depth of some surfaces of a tool in a part, or for their distance from it.

use crate::certify::bounds::hull::Hull;
use crate::certify::bounds::shell::Shell;
use crate::certify::search::QuerySetting;
use crate::certify::tool_model::field::Field;
use crate::certify::tool_model::owners::Owners;
use crate::certify::tool_model::section::Section;

/// A set of surfaces and the structures that bound their depth. Lengths are in the tool's unit.
pub(crate) struct DepthQuery {
    pub(crate) owners: Owners,
    pub(crate) hull: Hull<f32>,
    pub(crate) exact: Hull<f64>,
    pub(crate) shell: Shell,
    /// The allowed depth of the owners. If negative, its magnitude is the distance that they have to keep.
    pub(crate) limit: f64,
}

impl DepthQuery {
    /// A query for the features of some surfaces. `margin` is the rounding error of a point in `f32`.
    pub(crate) fn new(
        section: &Section,
        margin: f64,
        limit: f64,
        surfaces: impl Fn(usize) -> bool,
    ) -> DepthQuery {
        if limit < 0.0 {
            let owners = Owners::near(section, surfaces);
            return DepthQuery {
                hull: Hull::holding(section, &owners, margin),
                exact: Hull::holding(section, &owners, section.error),
                shell: Shell::new(section, &owners),
                owners,
                limit,
            };
        }
        let owners = Owners::of(section, surfaces);
        let zones = owners.zones(section, limit - 8.0 * section.error);
        DepthQuery {
            hull: Hull::new(section, &zones, margin),
            exact: Hull::new(section, &zones, section.error),
            shell: Shell::new(section, &owners),
            owners,
            limit,
        }
    }

    /// A query for some surfaces of a tool that is known by its depth field. `errors` are the rounding errors of a
    /// point in `f32` and in `f64`.
    pub(crate) fn of_field(
        field: &Field<'_>,
        errors: [f64; 2],
        limit: f64,
        surfaces: impl Fn(usize) -> bool,
    ) -> DepthQuery {
        let info = field.info();
        DepthQuery {
            owners: Owners::of_regions(info, |_, region| surfaces(region.surface.0)),
            hull: Hull::about(info, field.steep, errors[0]),
            exact: Hull::about(info, field.steep, errors[1]),
            shell: Shell::about(info),
            limit,
        }
    }

    /// Returns the queries that check the allowances of all surfaces, given in the order of the tool's list: one
    /// query per allowance, for all surfaces that have it. The largest allowance comes first; infinite ones need no
    /// query.
    pub(crate) fn all(setting: &QuerySetting<'_>, allowed: &[f64]) -> Vec<DepthQuery> {
        let depths =
            allowed.iter().map(|allowed| allowed.max(0.0)).filter(|depth| depth.is_finite());
        let gaps = allowed.iter().copied().filter(|allowed| *allowed < 0.0);
        let mut limits: Vec<f64> = depths.chain(gaps).collect();
        limits.sort_by(f64::total_cmp);
        limits.dedup();
        let query = |limit: f64| {
            setting.depth_query(limit, |surface| {
                let allowed = allowed[surface];
                if limit < 0.0 { allowed == limit } else { allowed.max(0.0) == limit }
            })
        };
        limits.into_iter().rev().map(query).collect()
    }
}
