//! What is found out about a tool under one item: the worst of each kind of figure, and where.

/// The item of the list of stresses that a figure belongs to: 1 to 13, and what goes beyond them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Item(pub usize);

/// The items' names, from the first on.
pub const ITEMS: [&str; 14] = [
    "exactly on vertices, curves and surfaces",
    "one ulp to either side",
    "as near to several features",
    "on the axis and beside it",
    "the whole scene scaled",
    "the whole scene moved",
    "aligned poses, and hardly tilted ones",
    "tangent contacts",
    "degenerate profiles",
    "input that is none",
    "trees of few points",
    "cycles with a checksum",
    "denormal numbers",
    "turned, mirrored, spun, merged, reordered, in another unit",
];

impl Item {
    /// All of them.
    pub fn all() -> impl Iterator<Item = Item> {
        (1..=ITEMS.len()).map(Item)
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        ITEMS[self.0 - 1]
    }
}

/// A kind of figure: what is measured, in what, and how much is allowed. What is counted has a bar of 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kind {
    /// What it is.
    pub what: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// The most that is allowed.
    pub bar: f64,
}

impl Kind {
    /// A kind with a bar.
    pub const fn of(what: &'static str, unit: &'static str, bar: f64) -> Kind {
        Kind { what, unit, bar }
    }

    /// Something that must not happen.
    pub const fn never(what: &'static str) -> Kind {
        Kind { what, unit: "times", bar: 0.0 }
    }

    /// A figure without a bar, for information.
    pub const fn told(what: &'static str, unit: &'static str) -> Kind {
        Kind { what, unit, bar: f64::INFINITY }
    }
}

/// The worst of a kind.
#[derive(Clone, Debug)]
pub struct Row {
    /// Under which item.
    pub item: Item,
    /// Of which kind.
    pub kind: Kind,
    /// The tool.
    pub tool: String,
    /// How many were looked at.
    pub cases: usize,
    /// The worst figure; of what is counted how often it happened.
    pub worst: f64,
    /// Where that is, to the last bit; of what is counted the first.
    pub place: String,
}

impl Row {
    /// Whether the bar is missed.
    pub fn missed(&self) -> bool {
        self.worst.is_nan() || self.worst > self.kind.bar
    }

    /// The figure as a part of its bar; of what is counted 0 or infinity.
    pub fn share(&self) -> f64 {
        if self.worst == 0.0 { 0.0 } else { self.worst / self.kind.bar }
    }

    /// What is missed, for people.
    pub fn shown(&self) -> String {
        let Row { item, kind, tool, cases, worst, place } = self;
        let Kind { what, unit, bar } = kind;
        format!("{} {tool}: {what} {worst:.3e} {unit} > {bar}, of {cases}, at {place}", item.0)
    }
}

/// The rows of a tool under an item, as they come.
pub struct Ledger {
    item: Item,
    tool: String,
    rows: Vec<Row>,
}

impl Ledger {
    /// An empty one.
    pub fn new(item: Item, tool: &str) -> Ledger {
        Ledger { item, tool: tool.to_owned(), rows: Vec::new() }
    }

    /// Under which item.
    pub fn item(&self) -> Item {
        self.item
    }

    /// Takes a figure. What is no number is the worst of all.
    pub fn see(&mut self, kind: Kind, figure: f64, place: impl FnOnce() -> String) {
        let row = self.row(kind);
        row.cases += 1;
        let figure = if figure.is_nan() { f64::INFINITY } else { figure };
        if figure > row.worst {
            row.worst = figure;
            row.place = place();
        }
    }

    /// Counts a case, and whether it is one that must not be.
    pub fn count(&mut self, kind: Kind, wrong: bool, place: impl FnOnce() -> String) {
        let row = self.row(kind);
        row.cases += 1;
        if wrong {
            if row.worst == 0.0 {
                row.place = place();
            }
            row.worst += 1.0;
        }
    }

    /// Notes a case of something that is told without a bar.
    pub fn tell(&mut self, kind: Kind, cases: usize, figure: f64, place: &str) {
        let row = self.row(kind);
        row.cases += cases;
        if figure > row.worst || row.place.is_empty() {
            row.worst = row.worst.max(figure);
            place.clone_into(&mut row.place);
        }
    }

    fn row(&mut self, kind: Kind) -> &mut Row {
        let known = self.rows.iter().position(|row| row.kind == kind);
        let index = known.unwrap_or_else(|| {
            let (item, tool) = (self.item, self.tool.clone());
            self.rows.push(Row { item, kind, tool, cases: 0, worst: 0.0, place: String::new() });
            self.rows.len() - 1
        });
        &mut self.rows[index]
    }

    /// The rows, in the order in which their kinds came.
    pub fn rows(self) -> Vec<Row> {
        self.rows
    }
}
