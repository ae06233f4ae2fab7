//! The guarantees that passes rely on, checked between the passes in debug builds and tests.
//!
//! The table *Guarantees of each pass* of [`model`](crate::model) states them. A guarantee that is a proof (the owner of each point,
//! the distance) is checked by the tests of its pass and by `prove`; here are those that a look at the data decides.

use crate::domain::Domain;
use crate::expr::{Coord, Id, Node};
use crate::formula::Formula;
use crate::model::{Model, Profile};
use crate::plan::{MAX_TESTS, PlannedTool, Tree};
use crate::regionalise::overlay::{ConditionedPart, Division};
use touchoff_plane::Circle;

/// A guarantee that does not hold: a fault of the compiler.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Broken {
    /// An expression is an operand of itself, directly or through others.
    Operand { node: usize },
    /// An expression is not in the graph.
    Expression { what: &'static str },
    /// A tool reads a coordinate that its half plane lacks, or a length that is no output's.
    Coordinate { what: &'static str, coord: Coord },
    /// There are no regions.
    NoRegion,
    /// A region or a segment has the index of no surface.
    Surface { index: usize },
    /// A formula or a tree has the index of no curve.
    Curve { index: usize },
    /// A tree or a division has the index of no region, or of no part.
    Region { index: usize },
    /// An outline is open, leaves the axis, or runs clockwise.
    Outline,
    /// A constant that code needs is no finite double.
    Constant,
    /// `plan` has changed a curve of the file.
    FileCurve { index: usize },
    /// A tree has more tests than allowed.
    Tests,
}

/// Checks what `resolve` guarantees of a model.
pub(crate) fn model(model: &Model) -> Result<(), Broken> {
    for (index, node) in model.graph.nodes().iter().enumerate() {
        if node.operands().any(|operand| operand.index() >= index) {
            return Err(Broken::Operand { node: index });
        }
    }
    let surface = |index: usize| match index < model.surfaces.len() {
        true => Ok(()),
        false => Err(Broken::Surface { index }),
    };
    for curve in &model.curves {
        function(model, "a curve", [curve.value])?;
    }
    for index in &model.first_curves {
        self::curve(model, *index)?;
    }
    if model.regions.is_empty() {
        return Err(Broken::NoRegion);
    }
    for region in &model.regions {
        surface(region.surface)?;
        formula(model, &region.condition)?;
        let values = [region.depth, region.magnitude, region.niceness];
        function(model, "a depth, magnitude or niceness", values)?;
        function(model, "a direction", region.direction.into_iter().chain(region.raw_direction.0))?;
        expressions(model, "an output", region.outputs.roots())?;
    }
    let Some(profile) = &model.profile else { return Ok(()) };
    profile.outline.iter().try_for_each(|segment| surface(segment.geometry.surface))?;
    outline(profile)?;
    let count = model.regions.len();
    let features = profile.inner.section().features().len();
    let Some(over) = &profile.over else {
        return if count == features { Ok(()) } else { Err(Broken::Region { index: count }) };
    };
    if over.regions.len() != count {
        return Err(Broken::Region { index: count });
    }
    if let Division::Conditions(formulas) = &over.division {
        formulas.iter().try_for_each(|condition| formula(model, condition))?;
    }
    for ConditionedPart { part, condition } in &over.regions {
        if *condition >= over.division.count() || *part >= features {
            return Err(Broken::Region { index: *condition });
        }
    }
    Ok(())
}

/// Checks what `plan` guarantees besides. `file_curves` are the curves of the model before it.
pub(crate) fn planned(file_curves: &[Id], tool: &PlannedTool) -> Result<(), Broken> {
    let PlannedTool { model: planned, .. } = tool;
    model(planned)?;
    for (index, curve) in file_curves.iter().enumerate() {
        if planned.curves.get(index).is_none_or(|known| known.value != *curve) {
            return Err(Broken::FileCurve { index });
        }
    }
    tree(planned, &tool.tree)?;
    let outputs = planned.regions.iter().flat_map(|region| region.outputs.roots());
    let curves = planned.curves.iter().map(|curve| curve.value);
    let is_finite =
        |id: &Id| planned.graph.constant(*id).is_none_or(|value| value.to_f64().is_finite());
    match planned.graph.dependencies(outputs.chain(curves)).iter().all(is_finite) {
        true => Ok(()),
        false => Err(Broken::Constant),
    }
}

/// Checks a tree: its curves, its owners, and its size.
fn tree(model: &Model, tree: &Tree) -> Result<(), Broken> {
    if tree.test_count() > MAX_TESTS {
        return Err(Broken::Tests);
    }
    let mut rest = vec![tree];
    while let Some(tree) = rest.pop() {
        match tree {
            Tree::Leaf(Some(index)) if *index >= model.regions.len() => {
                return Err(Broken::Region { index: *index });
            }
            Tree::Leaf(_) => {}
            Tree::Split { curve, below, above, .. } => {
                self::curve(model, *curve)?;
                rest.extend([&**below, &**above]);
            }
        }
    }
    Ok(())
}

fn curve(model: &Model, index: usize) -> Result<(), Broken> {
    if index < model.curves.len() { Ok(()) } else { Err(Broken::Curve { index }) }
}

fn formula(model: &Model, formula: &Formula) -> Result<(), Broken> {
    match formula {
        Formula::Const(_) => Ok(()),
        Formula::Atom { curve, .. } => self::curve(model, *curve),
        Formula::All(parts) | Formula::Any(parts) => {
            parts.iter().try_for_each(|part| self::formula(model, part))
        }
    }
}

/// Checks that expressions are in the graph.
fn expressions(
    model: &Model,
    what: &'static str,
    roots: impl IntoIterator<Item = Id>,
) -> Result<(), Broken> {
    match roots.into_iter().all(|id| id.index() < model.graph.nodes().len()) {
        true => Ok(()),
        false => Err(Broken::Expression { what }),
    }
}

/// Checks that expressions are functions of a point of the domain.
fn function(
    model: &Model,
    what: &'static str,
    roots: impl IntoIterator<Item = Id>,
) -> Result<(), Broken> {
    let roots: Vec<Id> = roots.into_iter().collect();
    expressions(model, what, roots.iter().copied())?;
    for id in model.graph.dependencies(roots) {
        let Node::Coord(coord) = model.graph.node(id) else { continue };
        let is_known = match model.domain {
            Domain::HalfPlane => matches!(coord, Coord::D | Coord::Q | Coord::Z),
            Domain::Space => !matches!(coord, Coord::Length | Coord::PerLength),
        };
        if !is_known {
            return Err(Broken::Coordinate { what, coord: *coord });
        }
    }
    Ok(())
}

/// Checks that an outline runs from the axis to the axis, without a gap and counter-clockwise.
fn outline(profile: &Profile) -> Result<(), Broken> {
    let segments = &profile.outline;
    let (Some(first), Some(last)) = (segments.first(), segments.last()) else {
        return Err(Broken::Outline);
    };
    let is_on_axis = |[d, _]: [f64; 2]| d == 0.0;
    let is_closed = is_on_axis(first.geometry.ends[0])
        && is_on_axis(last.geometry.ends[1])
        && segments.windows(2).all(|pair| pair[0].geometry.ends[1] == pair[1].geometry.ends[0]);
    // Twice the signed area: that of the chords, and that between each arc and its chord.
    let area: f64 = segments
        .iter()
        .map(|segment| {
            let [[d, z], [e, y]] = segment.geometry.ends;
            let turn = segment.geometry.turn();
            let radius = segment.geometry.circle.map_or(0.0, |Circle { radius, .. }| radius);
            d * y - e * z + radius * radius * (turn - turn.sin())
        })
        .sum();
    if is_closed && area > 0.0 { Ok(()) } else { Err(Broken::Outline) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan;
    use crate::{bound, resolve, source::Source, source::Sources, syntax};

    const MILL: &str = "tool Mill \"a mill\" { units mm; profile { start (0, 0); line to (5, 0) as tip cutting; \
                        arc to (8, 3) center (5, 3) as corner cutting; line to (8, 30), (0, 30) as shank; } \
                        niceness cutting: 1 - depth/9; }";

    /// The upper half of it is another region than the lower one.
    const SPHERE: &str = "solid Sphere \"a sphere\" { units mm; \
                          curve ball = hypot(x, y, z - 1) - 1; curve waist = z - 1; \
                          region low where ball <= 0, waist <= 0 { depth: -ball; } \
                          region high where ball <= 0, waist >= 0 { depth: -ball; } }";

    fn resolved(text: &str) -> Model {
        let source = Source::new("t.tool", text);
        let mut sources = Sources::new(source, std::iter::empty());
        let mut diagnostics = Vec::new();
        let tree = syntax::parse(sources.main(), &mut diagnostics);
        let tree = tree.unwrap_or_else(|_| panic!("{diagnostics:?}"));
        resolve::resolve(&tree, &[], &mut sources, &mut diagnostics)
            .unwrap_or_else(|_| panic!("{diagnostics:?}"))
    }

    fn planned(text: &str) -> (Model, PlannedTool) {
        let model = resolved(text);
        let extent = bound::extent(&model).unwrap_or_else(|found| panic!("{found:?}"));
        let tool = plan::plan(model.clone(), extent, &model.sampled_pieces())
            .unwrap_or_else(|found| panic!("{found:?}"));
        (model, tool)
    }

    fn curves(model: &Model) -> Vec<Id> {
        model.curves.iter().map(|curve| curve.value).collect()
    }

    #[test]
    fn what_passes_give_holds() {
        for text in [MILL, SPHERE] {
            let (file, tool) = planned(text);
            assert_eq!(model(&file), Ok(()));
            assert_eq!(super::planned(&curves(&file), &tool), Ok(()));
        }
    }

    /// Each guarantee of `resolve`, broken.
    #[test]
    fn a_broken_model_is_found() {
        let broken = |text: &str, edit: fn(&mut Model)| {
            let mut model = resolved(text);
            edit(&mut model);
            self::model(&model).err()
        };
        let beyond = |model: &Model| Formula::Atom { curve: model.curves.len(), below: true };
        let found = broken(SPHERE, |model| model.regions.clear());
        assert_eq!(found, Some(Broken::NoRegion));
        let found = broken(SPHERE, |model| model.regions[1].surface = 7);
        assert_eq!(found, Some(Broken::Surface { index: 7 }));
        let found = broken(MILL, |model| model.surfaces.truncate(2));
        assert_eq!(found, Some(Broken::Surface { index: 2 }));
        let found = broken(SPHERE, |model| model.first_curves.push(9));
        assert_eq!(found, Some(Broken::Curve { index: 9 }));
        let mut model = resolved(SPHERE);
        model.regions[0].condition = Formula::All(vec![beyond(&model)]);
        assert_eq!(self::model(&model), Err(Broken::Curve { index: model.curves.len() }));
        let found = broken(MILL, |model| model.regions[0].depth = model.graph.coord(Coord::X));
        let what = "a depth, magnitude or niceness";
        assert_eq!(found, Some(Broken::Coordinate { what, coord: Coord::X }));
        let found = broken(SPHERE, |model| {
            model.regions[0].niceness = model.graph.coord(Coord::Length);
        });
        assert_eq!(found, Some(Broken::Coordinate { what, coord: Coord::Length }));
        // The last expression of a greater graph.
        let mut other = resolved(MILL);
        let mut model = resolved(SPHERE);
        model.regions[0].outputs.depth = other.graph.int(123_456);
        assert!(other.graph.nodes().len() > model.graph.nodes().len());
        assert_eq!(self::model(&model), Err(Broken::Expression { what: "an output" }));
        for edit in [
            |profile: &mut Profile| drop(profile.outline.remove(1)),
            |profile: &mut Profile| drop(profile.outline.pop()),
            |profile: &mut Profile| profile.outline.clear(),
        ] {
            let mut model = resolved(MILL);
            edit(model.profile.as_mut().expect("a profile"));
            assert_eq!(self::model(&model), Err(Broken::Outline));
        }
    }

    /// Each guarantee of `plan`, broken.
    #[test]
    fn a_broken_plan_is_found() {
        let broken = |edit: fn(&mut PlannedTool)| {
            let (file, mut tool) = planned(SPHERE);
            edit(&mut tool);
            super::planned(&curves(&file), &tool).err()
        };
        let found = broken(|tool| tool.model.curves.swap(0, 1));
        assert_eq!(found, Some(Broken::FileCurve { index: 0 }));
        let found = broken(|tool| tool.tree = Tree::Leaf(Some(5)));
        assert_eq!(found, Some(Broken::Region { index: 5 }));
        let found = broken(|tool| {
            let [below, above] = [Tree::Leaf(Some(0)), Tree::Leaf(None)].map(Box::new);
            tool.tree = Tree::Split { curve: 99, strict: false, below, above };
        });
        assert_eq!(found, Some(Broken::Curve { index: 99 }));
        let found = broken(|tool| {
            let huge = crate::number::Number::from_f64(1e300).expect("a number");
            tool.model.regions[0].outputs.depth = tool.model.graph.number(&huge * &huge);
        });
        assert_eq!(found, Some(Broken::Constant));
        let found = broken(|tool| {
            let mut tree = Tree::Leaf(None);
            for k in 0..=MAX_TESTS {
                let [below, above] = [Tree::Leaf(Some(k % 2)), tree].map(Box::new);
                tree = Tree::Split { curve: 0, strict: false, below, above };
            }
            tool.tree = tree;
        });
        assert_eq!(found, Some(Broken::Tests));
    }
}
