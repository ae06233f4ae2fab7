//! Emission of a checked tool as Rust: straight-line code without loops, recursion, tables or panics, in two
//! forms of one plan. Emission cannot fail, since all errors are found earlier.

mod branches;
mod code;
mod dot;
mod lanes;
mod listing;
mod tokens;

pub use dot::dot;
pub use listing::{model, regions, tree};

use crate::bound::lateral_extent;
use crate::checked::CheckedTool;
use crate::diagnostic::format_number;
use crate::digest;
use crate::domain::Domain;
use crate::expr::Id;
use crate::model::RegionOutputs;
use crate::plan::Tree;
use code::{Form, Writer};
use proc_macro2::{Ident, Literal, Span, TokenStream};
use quote::{format_ident, quote};
use std::fmt::Write;
use tokens::{Tokens, literal};

/// Emits the type and its evaluators. The documentation of the type has no drawing, since an editor would
/// show it as text; see [`with_drawing`].
pub fn emit(tool: &CheckedTool) -> TokenStream {
    code(tool, &quote! {})
}

/// The same with a drawing of the tool, an SVG of one line, on the type's page, for rustdoc.
pub fn with_drawing(tool: &CheckedTool, drawing: &str) -> TokenStream {
    // One line inside a block element, so that nothing in it is parsed as Markdown.
    let drawing = format!("<div>{drawing}</div>");
    code(tool, &quote! { #[doc = ""] #[doc = #drawing] })
}

fn code(tool: &CheckedTool, drawing: &TokenStream) -> TokenStream {
    let name = Ident::new(&tool.model.name, Span::call_site());
    let docs = documentation(tool);
    let info = info(tool);
    let scalar = scalar(tool);
    let lanes = lanes::evaluator(tool);
    // A profile needs no enclosure by interval evaluation: its geometry is known.
    let enclose = tool.model.outline().next().is_none().then(|| {
        quote! {
            fn enclose(sides: [::touchoff::Interval; 3], at: [f64; 3]) -> Option<EvaluationEnclosure> {
                Some(EvaluationEnclosure::of::<Self>(sides, at))
            }
        }
    });
    quote! {
        #[doc = #docs]
        #drawing
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
        pub struct #name;

        #[allow(clippy::all, clippy::pedantic, unused_imports, unused_variables, unused_parens)]
        const _: () = {
            use ::touchoff::tool::{
                Outputs, ToolInfo, Circle, DepthBounds, EvaluationEnclosure, Evaluators, LaneEvaluation, Lane, ProfileSegment, Region, Symmetry,
                EnvelopeSlab, Surface,
            };

            impl Evaluators for #name {
                #info
                #scalar
                #enclose
                #lanes
            }
        };
    }
}

/// Emits a type that has the tool's name and no meaning. After an error it prevents further errors in code
/// that uses the tool, so that one mistake gives one message.
pub fn placeholder(name: &str) -> TokenStream {
    let name = Ident::new(name, Span::call_site());
    let mut functions = quote! { fn info() -> &'static ToolInfo { ::core::unreachable!() } };
    let empty = quote! { ::core::unreachable!() };
    functions.extend(quote! {
        fn evaluate_lanes<L: Lane>(
            point: [L; 3], length: L, present: L::Mask, outputs: Outputs,
        ) -> LaneEvaluation<L> { #empty }
    });
    functions.extend(function("contains", false, &quote! { bool }, &empty));
    functions.extend(function("owner", false, &quote! { Option<usize> }, &empty));
    functions.extend(function("clearance", false, &quote! { f64 }, &empty));
    for output in &OUTPUTS {
        functions.extend(function(output.name, output.with_length, &output.result(), &empty));
    }
    quote! {
        #[allow(missing_docs)]
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
        pub struct #name;

        #[allow(unused)]
        const _: () = {
            use ::touchoff::tool::{Outputs, ToolInfo, Evaluators, LaneEvaluation, Lane};
            impl Evaluators for #name { #functions }
        };
    }
}

fn documentation(tool: &CheckedTool) -> String {
    let model = &tool.model;
    let mut text = format!(
        "{}\n\nUnit: {}. {}.\n\n\
         | region | surface |\n|---|---|\n",
        model.title.as_deref().unwrap_or(&model.name),
        model.unit.symbol(),
        reach(tool),
    );
    for region in &model.regions {
        let surface = &model.surfaces[region.surface];
        let cutting = if surface.cutting { ", cutting" } else { "" };
        // Writing to a String does not fail.
        let _ = writeln!(text, "| {} | {}{cutting} |", region.name, surface.name);
    }
    text
}

/// Describes the extent of a tool along its axis and around it, or of a solid along x, y and z.
fn reach(tool: &CheckedTool) -> String {
    let extent = &tool.extent;
    let tidy = |v: f64| format_number(if v.abs() < 1e-9 * extent.scale() { 0.0 } else { v });
    match tool.model.domain {
        Domain::HalfPlane => format!(
            "Reaches from z = {} to {}, and {} from the axis",
            tidy(extent.low),
            tidy(extent.high),
            tidy(extent.radius),
        ),
        Domain::Space => {
            let sides = extent.cell().sides;
            let [x, y, z] = sides.map(|side| format!("{} to {}", tidy(side.low), tidy(side.high)));
            format!("A solid without an axis: reaches from x = {x}, y = {y}, z = {z}")
        }
    }
}

fn info(tool: &CheckedTool) -> TokenStream {
    let model = &tool.model;
    let name = &model.name;
    let title = model.title.as_deref().unwrap_or("");
    let unit = Ident::new(&format!("{:?}", model.unit), Span::call_site());
    let surfaces = model.surfaces.iter().map(|surface| {
        let (name, cutting) = (&surface.name, surface.cutting);
        quote! { Surface::new(#name, #cutting) }
    });
    let regions = model.regions.iter().map(|region| {
        let (name, surface) = (&region.name, region.surface);
        quote! { Region::new(#name, #surface) }
    });
    let slabs = tool.envelope().iter().map(|slab| {
        let [low, high, radius] = [slab.low, slab.high, slab.radius].map(literal);
        quote! { EnvelopeSlab::new(#low, #high, #radius) }
    });
    let pieces = model.outline().map(|piece| {
        let [[fd, fz], [td, tz]] = piece.ends.map(|end| end.map(literal));
        let surface = piece.surface;
        match piece.circle {
            None => quote! { ProfileSegment::line([#fd, #fz], [#td, #tz], #surface) },
            Some((centre, radius, convex)) => {
                let ([cd, cz], radius) = (centre.map(literal), literal(radius));
                quote! {
                    ProfileSegment::arc(
                        [[#fd, #fz], [#td, #tz]],
                        Circle { centre: [#cd, #cz], radius: #radius, convex: #convex },
                        #surface,
                    )
                }
            }
        }
    });
    let digest = Literal::u64_suffixed(digest(tool));
    let rounding = literal(tool.bounds().rounding_error);
    let [lower_slope, lipschitz] =
        [tool.bounds().lower_slope, tool.bounds().lipschitz].map(|bound| match bound {
            Some(bound) => {
                let bound = literal(bound);
                quote! { Some(#bound) }
            }
            None => quote! { None },
        });
    let shape = match model.domain {
        Domain::HalfPlane => quote! { Symmetry::Revolved },
        Domain::Space => {
            let [x, y] = lateral_extent(&tool.extent).map(|ends| {
                let [low, high] = ends.map(literal);
                quote! { ::touchoff::Interval::new(#low, #high) }
            });
            quote! { Symmetry::Solid { extent: [#x, #y] } }
        }
    };
    quote! {
        fn info() -> &'static ToolInfo {
            static SURFACES: &[Surface] = &[#(#surfaces),*];
            static REGIONS: &[Region] = &[#(#regions),*];
            static SLABS: &[EnvelopeSlab] = &[#(#slabs),*];
            static OUTLINE: &[ProfileSegment] = &[#(#pieces),*];
            static INFO: ToolInfo = ToolInfo::new(
                [#name, #title],
                ::touchoff::Unit::#unit,
                (SURFACES, REGIONS),
                (#shape, SLABS),
                (OUTLINE, DepthBounds { lower_slope: #lower_slope, lipschitz: #lipschitz, rounding: #rounding }),
                #digest,
            );
            &INFO
        }
    }
}

/// One quantity that an evaluator computes.
struct Output {
    name: &'static str,
    /// True if it depends on the unit of the part.
    with_length: bool,
    vector: bool,
    of: fn(&RegionOutputs) -> Vec<Id>,
}

const OUTPUTS: [Output; 5] = [
    Output { name: "depth", with_length: false, vector: false, of: |o| vec![o.depth] },
    Output { name: "magnitude", with_length: true, vector: false, of: |o| vec![o.magnitude] },
    Output { name: "niceness", with_length: false, vector: false, of: |o| vec![o.niceness] },
    Output { name: "direction", with_length: false, vector: true, of: |o| o.direction.to_vec() },
    Output { name: "gradient", with_length: true, vector: true, of: |o| o.gradient.to_vec() },
];

impl Output {
    fn result(&self) -> TokenStream {
        if self.vector {
            quote! { [f64; 3] }
        } else {
            quote! { f64 }
        }
    }
}

/// Emits the evaluators for one point.
fn scalar(tool: &CheckedTool) -> TokenStream {
    let mut all =
        of_tests(tool, "contains", &quote! { bool }, &tool.plan.inside, &|code, inside| {
            code.word(if *inside { "true" } else { "false" });
        });
    let owner = |code: &mut Tokens, owner: &Option<usize>| {
        match owner {
            Some(index) => code.word("Some").paren(|code| {
                code.count(*index);
            }),
            None => code.word("None"),
        };
    };
    all.extend(of_tests(tool, "owner", &quote! { Option<usize> }, &tool.plan.owner, &owner));
    for output in &OUTPUTS {
        let tree = tool
            .plan
            .owner
            // Evaluators of outputs are not called outside, so those leaves are replaced by their siblings.
            .map(&|owner: &Option<usize>| {
                owner.map(|r| (output.of)(&tool.model.regions[r].outputs))
            });
        if let Some(tree) = tree {
            let body = body(tool, &tree);
            all.extend(function(output.name, output.with_length, &output.result(), &body));
        }
    }
    if let Some(tree) = tool.plan.clearance.map(&|id: &Id| Some(vec![*id])) {
        all.extend(function("clearance", false, &quote! { f64 }, &body(tool, &tree)));
    }
    all
}

fn function(name: &str, length: bool, result: &TokenStream, body: &TokenStream) -> TokenStream {
    let name = format_ident!("{name}");
    let extra = length.then(|| quote! { , length: f64 });
    quote! {
        #[inline]
        fn #name([x, y, z]: [f64; 3] #extra) -> #result { #body }
    }
}

/// Writes the body of a function whose leaves are one or three expressions.
fn body(tool: &CheckedTool, tree: &Tree<Vec<Id>>) -> TokenStream {
    let model = &tool.model;
    let mut roots = Vec::new();
    leaves(tree, &mut roots);
    let writer = Writer::of_tree(&model.graph, &model.curves, Form::Scalar, &roots, tree);
    let mut code = Tokens::default();
    writer.nested(&mut code, tree, &|ids: &Vec<Id>| ids.clone(), &|code, ids| {
        together(code, ids, |code, id| writer.leaf(code, *id));
    });
    let (given, code) = (writer.given(), code.done());
    quote! { #given #code }
}

/// Writes one value as it is, several as an array.
fn together<T>(code: &mut Tokens, values: &[T], one: impl Fn(&mut Tokens, &T)) {
    if let [only] = values {
        return one(code, only);
    }
    code.bracket(|code| {
        for (k, value) in values.iter().enumerate() {
            if k > 0 {
                code.sign(",");
            }
            one(code, value);
        }
    });
}

fn leaves(tree: &Tree<Vec<Id>>, roots: &mut Vec<Id>) {
    match tree {
        Tree::Leaf(ids) => roots.extend(ids),
        Tree::Split { below, above, .. } => {
            leaves(below, roots);
            leaves(above, roots);
        }
    }
}

/// Emits a function of a tree that needs nothing except its tests.
fn of_tests<L>(
    tool: &CheckedTool,
    name: &str,
    result: &TokenStream,
    tree: &Tree<L>,
    leaf: &impl Fn(&mut Tokens, &L),
) -> TokenStream {
    let model = &tool.model;
    let writer = Writer::of_tree(&model.graph, &model.curves, Form::Scalar, &[], tree);
    let mut code = Tokens::default();
    writer.nested(&mut code, tree, &|_| vec![], leaf);
    let (given, code) = (writer.given(), code.done());
    function(name, false, result, &quote! { #given #code })
}

/// Formats the code for people, without the drawing in its documentation.
pub fn source_code(tool: &CheckedTool) -> String {
    let tokens = code(tool, &quote! {});
    match syn::parse2(tokens.clone()) {
        Ok(file) => prettyplease::unparse(&file),
        Err(_) => tokens.to_string(),
    }
}
