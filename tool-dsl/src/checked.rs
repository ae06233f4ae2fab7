//! The last pass: a planned tool is linted, bounded, and proved to the extent that a build requires.

use crate::bound::{self, EnvelopeSlab};
use crate::diagnostic::{CheckKind, Diagnostic, Reported, without_error};
use crate::expr::{self, Id};
use crate::model::Model;
use crate::plan::{self, PlannedTool};
use crate::prove::Bounds;
use crate::{lint, validate};
use std::ops::Deref;

/// A tool in which no error was found, with everything that is emitted about it. Only
/// [`compile`](crate::compile()) constructs one.
///
/// It dereferences to the [`PlannedTool`] that was checked, without mutable access.
#[derive(Clone, Debug)]
pub struct CheckedTool {
    planned: PlannedTool,
    envelope: Vec<EnvelopeSlab>,
    bounds: Bounds,
}

impl CheckedTool {
    /// Returns the tool's largest radius along the axis, in slabs.
    pub fn envelope(&self) -> &[EnvelopeSlab] {
        &self.envelope
    }

    /// Returns the bounds of its depth, as far as a build proves them.
    pub fn bounds(&self) -> Bounds {
        self.bounds
    }

    /// Renames the tool, and with it the Rust type.
    pub(crate) fn rename(&mut self, name: &str) {
        name.clone_into(&mut self.planned.model.name);
    }
}

impl Deref for CheckedTool {
    type Target = PlannedTool;

    fn deref(&self) -> &PlannedTool {
        &self.planned
    }
}

/// Checks a model, plans its splits and bounds its depth.
///
/// # Errors
/// If the diagnostics contain an error.
pub(crate) fn check(
    model: Model,
    diagnostics: &mut Vec<Diagnostic>,
) -> Result<CheckedTool, Reported> {
    finite(&model).map_err(|diagnostic| Reported::push(diagnostics, diagnostic))?;
    let extent = match bound::extent(&model) {
        Ok(extent) => extent,
        // An undefined curve prevents bounding; report the undefined value instead of the missing bound.
        Err(diagnostic) => {
            diagnostics.extend(lint::undefined_curves(&model));
            let undefined = Reported::among(diagnostics);
            return Err(undefined.unwrap_or_else(|| Reported::push(diagnostics, diagnostic)));
        }
    };
    let sampled = model.sampled_pieces();
    diagnostics.extend(lint::lint(&model, &extent, &sampled));
    // The plan would only repeat these errors.
    without_error(diagnostics)?;
    let envelope = bound::envelope(&model, &extent);
    let file_curves: Vec<Id> = model.curve_values().collect();
    let planned = plan::plan(model, extent, &sampled)
        .map_err(|diagnostic| Reported::push(diagnostics, diagnostic))?;
    debug_assert_eq!(
        validate::planned(&file_curves, &planned),
        Ok(()),
        "`plan` keeps its guarantees"
    );
    let (bounds, found) = Bounds::of(&planned);
    // Samples may have shown that a depth is infinitely steep.
    let steep = |diagnostic: &Diagnostic, found: &Diagnostic| {
        diagnostic.code() == "T0618" && diagnostic.span == found.span
    };
    let known = diagnostics.len();
    for found in found {
        if !diagnostics[..known].iter().any(|diagnostic| steep(diagnostic, &found)) {
            diagnostics.push(found);
        }
    }
    without_error(diagnostics)?;
    Ok(CheckedTool { planned, envelope, bounds })
}

/// Checks that every constant that code needs is a finite double.
///
/// # Errors
/// [`CheckKind::ConstantOverflow`] if one overflows.
fn finite(model: &Model) -> Result<(), Diagnostic> {
    let outputs = model.regions.iter().flat_map(|region| region.outputs.roots());
    let curves = model.curve_values();
    let needed = model.graph.dependencies(outputs.chain(curves));
    let beyond =
        |id: &expr::Id| model.graph.constant(*id).is_some_and(|value| !value.to_f64().is_finite());
    if needed.iter().any(beyond) {
        return Err(Diagnostic::new(model.name_span, CheckKind::ConstantOverflow));
    }
    Ok(())
}
