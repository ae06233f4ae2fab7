//! Emission of a checked tool as Rust: one evaluator without loops, recursion, tables or panics, generic over numbers, vectors
//! of numbers, duals and enclosures. It branches only where no lane takes a side of a split or is in a region; everything
//! between two branches is straight-line code. Emission cannot fail, since all errors are found earlier.

mod alike;
mod code;
mod lanes;
mod listing;
mod names;
mod tokens;

pub use listing::dot;
pub use listing::{model, regions, tree};

use crate::bound::lateral_extent;
use crate::checked::CheckedTool;
use crate::diagnostic::format_number;
use crate::digest;
use crate::domain::Domain;
use crate::expr::Id;
use crate::model::RegionOutputs;
use proc_macro2::{Ident, Literal, Span, TokenStream};
use quote::quote;
use std::fmt::Write;
use tokens::literal;
use touchoff_plane::Circle;

/// The part of a tool's size below which a coordinate is shown as 0.
const ROUNDING_FRACTION: f64 = 1e-9;

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
    let lanes = lanes::evaluator(tool);
    // A profile needs no enclosure by interval evaluation: its geometry is known.
    let enclose = tool.model.outline().next().is_none().then(|| {
        quote! {
            fn enclose(
                sides: [::touchoff::Interval; 3], at: [f64; 3],
            ) -> Option<::touchoff::tool::EvaluationEnclosure> {
                Some(::touchoff::tool::EvaluationEnclosure::of::<Self>(sides, at))
            }
        }
    });
    quote! {
        #[doc = #docs]
        #drawing
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
        pub struct #name;

        #[allow(clippy::all, clippy::pedantic, unused_imports, unused_variables, unused_parens)]
        impl ::touchoff::tool::Evaluators for #name {
            #info
            #enclose
            #lanes
        }
    }
}

/// Emits a type that has the tool's name and no meaning. After an error it prevents further errors in code
/// that uses the tool, so that one mistake gives one message.
pub fn placeholder(name: &str) -> TokenStream {
    let name = Ident::new(name, Span::call_site());
    quote! {
        #[allow(missing_docs)]
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
        pub struct #name;

        #[allow(unused)]
        impl ::touchoff::tool::Evaluators for #name {
            fn info() -> &'static ::touchoff::tool::ToolInfo { ::core::unreachable!() }
            fn evaluate_lanes<L: ::touchoff::tool::Lane>(
                point: [L; 3], length: L, present: L::Mask, outputs: ::touchoff::tool::Outputs,
            ) -> ::touchoff::tool::LaneEvaluation<L> { ::core::unreachable!() }
        }
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
    let tidy =
        |v: f64| format_number(if v.abs() < ROUNDING_FRACTION * extent.scale() { 0.0 } else { v });
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
            Some(Circle { centre, radius, convex }) => {
                let ([cd, cz], radius) = (centre.map(literal), literal(radius));
                let circle = if convex { quote! { Circle::convex } } else { quote! { Circle::concave } };
                quote! { ProfileSegment::arc([[#fd, #fz], [#td, #tz]], #circle([#cd, #cz], #radius), #surface) }
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
    let symmetry = match model.domain {
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
        fn info() -> &'static ::touchoff::tool::ToolInfo {
            use ::std::borrow::Cow;
            use ::touchoff::tool::{
                Circle, DepthBounds, EnvelopeSlab, ProfileSegment, Region, Surface, Symmetry, ToolInfo,
            };
            static INFO: ToolInfo = ToolInfo {
                name: Cow::Borrowed(#name),
                title: Cow::Borrowed(#title),
                unit: ::touchoff::Unit::#unit,
                surfaces: Cow::Borrowed(&[#(#surfaces),*]),
                regions: Cow::Borrowed(&[#(#regions),*]),
                envelope: Cow::Borrowed(&[#(#slabs),*]),
                symmetry: #symmetry,
                outline: Cow::Borrowed(&[#(#pieces),*]),
                depth: DepthBounds { lower_slope: #lower_slope, lipschitz: #lipschitz, rounding: #rounding },
                digest: #digest,
            };
            &INFO
        }
    }
}

/// One quantity that the evaluator computes.
struct Output {
    name: &'static str,
    of: fn(&RegionOutputs) -> Vec<Id>,
}

const OUTPUTS: [Output; 5] = [
    Output { name: "depth", of: |o| vec![o.depth] },
    Output { name: "magnitude", of: |o| vec![o.magnitude] },
    Output { name: "niceness", of: |o| vec![o.niceness] },
    Output { name: "direction", of: |o| o.direction.to_vec() },
    Output { name: "gradient", of: |o| o.gradient.to_vec() },
];

/// Formats the code for people, without the drawing in its documentation.
#[cfg(feature = "source-code")]
pub fn source_code(tool: &CheckedTool) -> String {
    let tokens = code(tool, &quote! {});
    match syn::parse2(tokens.clone()) {
        Ok(file) => prettyplease::unparse(&file),
        Err(_) => tokens.to_string(),
    }
}
