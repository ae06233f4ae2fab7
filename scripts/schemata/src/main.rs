//! Writes mutants into a source tree, each behind a switch that is thrown when the tests run:
//!     schemata TREE MUTANTS LEFT_OUT RANGES
//! `MUTANTS` is what `cargo mutants --list --json` prints, `LEFT_OUT` a list of indices in it, and `RANGES` is written: for each file, the ranges
//! of bytes that belong to mutants, by which an error of the compiler is traced to its mutant. One build then serves all mutants
//! (R. Untch, J. Offutt and M. Harrold, *Mutation analysis using mutant schemata*, 1993).
use proc_macro2::LineColumn;
use serde::Deserialize;
use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::ops::Range;
use std::path::Path;
use syn::spanned::Spanned;
use syn::visit::{self, Visit};

#[derive(Deserialize)]
struct Mutant {
    file: String,
    genre: String,
    replacement: String,
    span: Place,
}

#[derive(Deserialize)]
struct Place {
    start: Position,
}

#[derive(Clone, Copy, Deserialize, PartialEq, Eq, Hash)]
struct Position {
    line: usize,
    column: usize,
}

impl From<LineColumn> for Position {
    fn from(LineColumn { line, column }: LineColumn) -> Position {
        Position { line, column: column + 1 }
    }
}

/// A change of the text: what stands in the place of a range.
struct Edit {
    at: Range<usize>,
    order: Order,
    text: String,
    mutants: Vec<usize>,
    is_begin: bool,
}

/// The order of edits at one offset: inner expressions end, functions begin, expressions begin from the outermost on, and the rest.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Order {
    End {
        length: usize,
    },
    Function,
    /// The outer of expressions of one length is visited last.
    Begin {
        length: Reverse<usize>,
        visited: Reverse<usize>,
    },
    Rest,
}

struct Edits<'a> {
    text: &'a str,
    mutants: HashMap<Position, Vec<(usize, &'a Mutant)>>,
    edits: Vec<Edit>,
}

impl Edits<'_> {
    /// Returns the mutants at a place, which are then used.
    fn at(&self, place: LineColumn, genre: &str) -> Vec<(usize, String)> {
        let found = self.mutants.get(&place.into()).into_iter().flatten();
        found
            .filter(|(_, mutant)| mutant.genre == genre)
            .map(|(n, mutant)| (*n, mutant.replacement.clone()))
            .collect()
    }

    /// Puts texts around an expression; the first replaces `begin`, which may be empty.
    fn wrap(&mut self, begin: Range<usize>, end: usize, texts: [String; 2], mutants: &[usize]) {
        let length = end - begin.start;
        let visited = Reverse(self.edits.len());
        let [first, last] = texts;
        let mutants = mutants.to_vec();
        self.edits.push(Edit {
            at: begin,
            order: Order::Begin { length: Reverse(length), visited },
            text: first,
            mutants: mutants.clone(),
            is_begin: true,
        });
        self.edits.push(Edit {
            at: end..end,
            order: Order::End { length },
            text: last,
            mutants,
            is_begin: false,
        });
    }

    /// Inserts a text of its own.
    fn insert(&mut self, at: usize, text: String, mutants: &[usize], order: Order) {
        let edit =
            |text, is_begin| Edit { at: at..at, order, text, mutants: mutants.to_vec(), is_begin };
        self.edits.extend([edit(text, true), edit(String::new(), false)]);
    }

    fn replace(&mut self, at: Range<usize>, text: String) {
        self.edits.push(Edit {
            at,
            order: Order::Rest,
            text,
            mutants: Vec::new(),
            is_begin: false,
        });
    }
}

/// Returns the beginning of a choice by the switches: what follows is the block of no switch.
fn cases(options: &[(usize, String)]) -> String {
    let case =
        |(n, text): &(usize, String)| format!("if crate::mutant::on({n}) {{ {text} }} else ");
    options.iter().map(case).collect()
}

/// Returns the choice of one of several texts, by the switches.
fn choice(options: &[(usize, String)], otherwise: &str) -> String {
    format!("{}{{ {otherwise} }}", cases(options))
}

impl<'ast> Visit<'ast> for Edits<'_> {
    fn visit_expr_binary(&mut self, binary: &'ast syn::ExprBinary) {
        visit::visit_expr_binary(self, binary);
        let options = self.at(binary.op.span().start(), "BinaryOperator");
        let has_let =
            [&binary.left, &binary.right].iter().any(|side| matches!(***side, syn::Expr::Let(_)));
        if options.is_empty() || has_let {
            return;
        }
        let numbers: Vec<usize> = options.iter().map(|(n, _)| *n).collect();
        let [left, op, right] = [binary.left.span(), binary.op.span(), binary.right.span()]
            .map(|span| span.byte_range());
        let sign = self.text[op.clone()].to_owned();
        let begin = left.start..left.start;
        let with = |left: &str, right: &str| -> String {
            let options: Vec<_> =
                options.iter().map(|(n, sign)| (*n, format!("{left} {sign} {right}"))).collect();
            choice(&options, &format!("{left} {sign} {right}"))
        };
        match sign.as_str() {
            "&&" | "||" => {
                let (is, [n]) = (if sign == "&&" { "!=" } else { "==" }, &numbers[..]) else {
                    return;
                };
                self.replace(op, format!(") {{ l => if l {is} crate::mutant::on({n}) {{ "));
                self.wrap(
                    begin,
                    right.end,
                    ["(match (".into(), " } else { l } })".into()],
                    &numbers,
                );
            }
            "==" | "!=" | "<" | "<=" | ">" | ">=" => {
                self.replace(op, "), &(".into());
                let end = format!(")) {{ (l, r) => {} }})", with("*l", "*r"));
                self.wrap(begin, right.end, ["(match (&(".into(), end], &numbers);
            }
            _ if sign.ends_with('=') => {
                let options: Vec<_> = options
                    .iter()
                    .map(|(n, sign)| (*n, format!("l {} r", sign.trim_end_matches('='))))
                    .collect();
                let end = format!(
                    ") {{ (l, r) => {} }})",
                    choice(&options, &format!("l {} r", sign.trim_end_matches('=')))
                );
                let left = self.text[left].to_owned();
                self.replace(op, format!("= (match ({left}, "));
                self.wrap(begin, right.end, [String::new(), end], &numbers);
            }
            _ => {
                self.replace(op, ", ".into());
                let end = format!(") {{ (l, r) => {} }})", with("l", "r"));
                self.wrap(begin, right.end, ["(match (".into(), end], &numbers);
            }
        }
    }

    fn visit_expr_unary(&mut self, unary: &'ast syn::ExprUnary) {
        visit::visit_expr_unary(self, unary);
        let op = unary.op.span();
        if let [(n, _)] = self.at(op.start(), "UnaryOperator")[..] {
            let end = format!(
                ") {{ e => if crate::mutant::on({n}) {{ e }} else {{ {}e }} }})",
                &self.text[op.byte_range()]
            );
            self.wrap(
                op.byte_range(),
                unary.expr.span().byte_range().end,
                ["(match (".into(), end],
                &[n],
            );
        }
    }

    fn visit_arm(&mut self, arm: &'ast syn::Arm) {
        visit::visit_arm(self, arm);
        let deleted = self.at(arm.pat.span().start(), "MatchArm");
        let condition = arm.guard.as_ref().map(|(_, guard)| &**guard);
        let mut tests: Vec<(usize, String)> =
            deleted.into_iter().map(|(n, _)| (n, "false".into())).collect();
        if let Some(guard) = condition {
            tests.extend(self.at(guard.span().start(), "MatchArmGuard"));
        }
        if tests.is_empty() {
            return;
        }
        let numbers: Vec<usize> = tests.iter().map(|(n, _)| *n).collect();
        match condition {
            Some(guard) => {
                let at = guard.span().byte_range();
                self.wrap(
                    at.start..at.start,
                    at.end,
                    [format!("({}{{ ", cases(&tests)), " })".into()],
                    &numbers,
                );
            }
            None => {
                let end = arm.pat.span().byte_range().end;
                self.insert(
                    end,
                    format!(" if !crate::mutant::on({})", numbers[0]),
                    &numbers,
                    Order::Rest,
                );
            }
        }
    }
}

/// Returns the offset of a place in a text.
fn offset(text: &str, place: Position) -> usize {
    let line = text.split_inclusive('\n').take(place.line - 1).map(str::len).sum::<usize>();
    line + text[line..].char_indices().nth(place.column - 1).map_or(0, |(at, _)| at)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().collect();
    let [_, tree, mutants, left_out, ranges] = &arguments[..] else {
        return Err("schemata TREE MUTANTS LEFT_OUT RANGES".into());
    };
    let tree = Path::new(tree);
    let mutants: Vec<Mutant> = serde_json::from_str(&std::fs::read_to_string(mutants)?)?;
    let left_out: Vec<usize> = serde_json::from_str(&std::fs::read_to_string(left_out)?)?;
    let mut files: BTreeMap<&str, Vec<(usize, &Mutant)>> = BTreeMap::new();
    for (n, mutant) in mutants.iter().enumerate().filter(|(n, _)| !left_out.contains(n)) {
        files.entry(&mutant.file).or_default().push((n, mutant));
    }
    let mut all_ranges = BTreeMap::new();
    for (name, list) in files {
        let text = std::fs::read_to_string(tree.join(name))?;
        let mut edits = Edits { text: &text, mutants: HashMap::new(), edits: Vec::new() };
        for (n, mutant) in list {
            if mutant.genre == "FnValue" {
                let at = offset(&text, mutant.span.start);
                let value = if mutant.replacement == "()" { "" } else { &mutant.replacement };
                let insertion = format!("if crate::mutant::on({n}) {{ return {value}; }} ");
                edits.insert(at, insertion, &[n], Order::Function);
            } else {
                edits.mutants.entry(mutant.span.start).or_default().push((n, mutant));
            }
        }
        edits.visit_file(&syn::parse_file(&text)?);
        let mut list = edits.edits;
        list.sort_by_key(|edit| (edit.at.start, edit.order));
        let (mut written, mut from) = (String::new(), 0);
        let mut open: Vec<(Vec<usize>, usize)> = Vec::new();
        let mut ranges = Vec::new();
        for edit in list {
            written += &text[from..edit.at.start];
            let begin = written.len();
            written += &edit.text;
            from = edit.at.end;
            if edit.is_begin {
                open.push((edit.mutants, begin));
            } else if !edit.mutants.is_empty() {
                let index = open
                    .iter()
                    .rposition(|(mutants, _)| *mutants == edit.mutants)
                    .ok_or("an end without a beginning")?;
                let (mutants, begin) = open.remove(index);
                ranges.push((begin, written.len(), mutants));
            }
        }
        written += &text[from..];
        std::fs::write(tree.join(name), written)?;
        all_ranges.insert(name.to_owned(), ranges);
    }
    let switch = include_str!("switch.rs").replace("COUNT]", &format!("{}]", mutants.len()));
    for package in ["runtime", "tool-dsl"] {
        std::fs::write(tree.join(package).join("src/mutant.rs"), &switch)?;
        let library = tree.join(package).join("src/lib.rs");
        let text = std::fs::read_to_string(&library)?;
        std::fs::write(library, format!("{text}\nmod mutant;\n"))?;
    }
    let placed: BTreeSet<usize> =
        all_ranges.values().flatten().flat_map(|(_, _, mutants)| mutants.clone()).collect();
    println!("{} of {} mutants are placed", placed.len(), mutants.len());
    std::fs::write(ranges, serde_json::to_string(&(all_ranges, placed))?)?;
    Ok(())
}
