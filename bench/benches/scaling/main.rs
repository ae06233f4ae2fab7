//! How this project's time grows: with the cloud, with what collides, with how far it is away.
//!
//! ```sh
//! cargo bench -p touchoff-bench --features peers --bench scaling -- --json
//! ```
//!
//! `--table` and `--points` choose among rows, `--poses` how finely a path is cut, `--seconds` how
//! long one row may take at each kind of timing. Without `--json` it prints Markdown. The tool is
//! that of fig. 7.3, the law the thesis's with area weights. What collides and what is apart is
//! asked of the largest cloud of at most a million points.

mod apart;
mod build;
mod contact;
mod memory;
mod passes;
mod query;
mod row;
mod table;

use crate::row::Row;
use clap::{Parser, ValueEnum};
use std::num::NonZeroUsize;
use touchoff::Part;
use touchoff::scenes::POSES;
use touchoff_bench::race::{clock, contender};

/// Times this project on clouds of a thousand to ten million points.
#[derive(Parser)]
struct Options {
    /// Only these tables.
    #[arg(long, value_delimiter = ',')]
    table: Vec<Table>,
    /// Points of the cloud.
    #[arg(
        long,
        value_delimiter = ',',
        default_value = "1000,2000,5000,10000,20000,50000,100000,200000,500000,1000000,10000000"
    )]
    points: Vec<NonZeroUsize>,
    /// Poses that a path is cut into.
    #[arg(long, default_value_t = NonZeroUsize::new(POSES).expect("some poses"))]
    poses: NonZeroUsize,
    /// How long each kind of timing may take for a row; poses sit out if need be.
    #[arg(long, default_value_t = 2.0)]
    seconds: f64,
    /// One object a row.
    #[arg(long)]
    json: bool,
    /// Passed by `cargo bench`.
    #[arg(long, hide = true)]
    bench: bool,
}

impl Options {
    fn has(&self, table: Table) -> bool {
        self.table.is_empty() || self.table.contains(&table)
    }

    /// The cloud that is asked what it takes to collide, and to be apart.
    fn largest(&self) -> Option<usize> {
        self.points.iter().map(|points| points.get()).filter(|points| *points <= MILLION).max()
    }
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Table {
    /// Detect and wrench along the paths.
    Query,
    /// Time by how many points collide.
    Contact,
    /// Detect and wrench at a distance.
    Apart,
    /// The cloud and its tree: time and bytes.
    Build,
}

const MILLION: usize = 1_000_000;

fn main() {
    let options = Options::parse();
    let pinned = clock::pin();
    let mut rows = Vec::new();
    for points in &options.points {
        let points = points.get();
        let (part, built) = build::build(points, options.seconds);
        let mut found = Vec::new();
        if options.has(Table::Build) {
            found.push(Row::Build(built));
        }
        measure(&part, &options, &mut found);
        if options.json {
            found.iter().for_each(table::json);
        }
        rows.extend(found);
    }
    if !options.json {
        table::markdown(&rows, pinned);
    }
}

/// All that is asked of one cloud.
fn measure(part: &Part, options: &Options, rows: &mut Vec<Row>) {
    if options.has(Table::Query) {
        rows.extend(query::paths(part, options).into_iter().map(Row::Query));
    }
    if Some(part.tree().len()) != options.largest() {
        return;
    }
    if options.has(Table::Contact) {
        contact::contact(part, options, rows);
    }
    if options.has(Table::Apart) {
        rows.extend(apart::apart(part, options).into_iter().map(Row::Apart));
    }
}
