//! Records of validation results per tool and item: the worst value of each kind, and its location.

/// An item of the stress list, 1 to 13, or the item of further tests.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Item(pub usize);

/// The items' names, starting with item 1.
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
    /// Returns all items.
    pub fn all() -> impl Iterator<Item = Item> {
        (1..=ITEMS.len()).map(Item)
    }

    /// Returns the item's name.
    pub fn name(self) -> &'static str {
        ITEMS[self.0 - 1]
    }
}

/// A kind of result: the quantity, its unit and its limit. Events that must not occur have the limit 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kind {
    /// The quantity.
    pub what: &'static str,
    /// The unit.
    pub unit: &'static str,
    /// The largest allowed value.
    pub bar: f64,
}

impl Kind {
    /// Makes a kind with a limit.
    pub const fn of(what: &'static str, unit: &'static str, bar: f64) -> Kind {
        Kind { what, unit, bar }
    }

    /// Makes a kind of event that must not occur.
    pub const fn never(what: &'static str) -> Kind {
        Kind { what, unit: "times", bar: 0.0 }
    }

    /// Makes a kind without a limit, for information.
    pub const fn told(what: &'static str, unit: &'static str) -> Kind {
        Kind { what, unit, bar: f64::INFINITY }
    }
}

/// The worst result of a kind.
#[derive(Clone, Debug)]
pub struct Row {
    /// The item.
    pub item: Item,
    /// The kind.
    pub kind: Kind,
    /// The tool, or the name of the case.
    pub tool: String,
    /// Number of results.
    pub cases: usize,
    /// The worst value, or the number of occurrences of an event.
    pub worst: f64,
    /// Location of the worst value, to the last bit, or of the first occurrence.
    pub place: String,
}

impl Row {
    /// Returns whether the limit is exceeded.
    pub fn missed(&self) -> bool {
        self.worst.is_nan() || self.worst > self.kind.bar
    }

    /// Returns the worst value divided by the limit; for events 0 or infinity.
    pub fn share(&self) -> f64 {
        if self.worst == 0.0 { 0.0 } else { self.worst / self.kind.bar }
    }

    /// Returns a description of a missed limit.
    pub fn shown(&self) -> String {
        let Row { item, kind, tool, cases, worst, place } = self;
        let Kind { what, unit, bar } = kind;
        format!("{} {tool}: {what} {worst:.3e} {unit} > {bar}, of {cases}, at {place}", item.0)
    }
}

/// The rows of a tool under an item, collected one result at a time.
pub struct Ledger {
    item: Item,
    tool: String,
    rows: Vec<Row>,
}

impl Ledger {
    /// Makes an empty ledger.
    pub fn new(item: Item, tool: &str) -> Ledger {
        Ledger { item, tool: tool.to_owned(), rows: Vec::new() }
    }

    /// Returns the item.
    pub fn item(&self) -> Item {
        self.item
    }

    /// Records a value. NaN counts as infinite.
    pub fn see(&mut self, kind: Kind, figure: f64, place: impl FnOnce() -> String) {
        let row = self.row(kind);
        row.cases += 1;
        let figure = if figure.is_nan() { f64::INFINITY } else { figure };
        if figure > row.worst {
            row.worst = figure;
            row.place = place();
        }
    }

    /// Records a case, and whether the event occurred.
    pub fn count(&mut self, kind: Kind, occurred: bool, place: impl FnOnce() -> String) {
        let row = self.row(kind);
        row.cases += 1;
        if occurred {
            if row.worst == 0.0 {
                row.place = place();
            }
            row.worst += 1.0;
        }
    }

    /// Records `cases` cases of a kind without a limit.
    pub fn tell(&mut self, kind: Kind, cases: usize, figure: f64, place: &str) {
        let row = self.row(kind);
        row.cases += cases;
        if figure > row.worst || row.place.is_empty() {
            row.worst = row.worst.max(figure);
            place.clone_into(&mut row.place);
        }
    }

    fn row(&mut self, kind: Kind) -> &mut Row {
        let existing = self.rows.iter().position(|row| row.kind == kind);
        let index = existing.unwrap_or_else(|| {
            let (item, tool) = (self.item, self.tool.clone());
            self.rows.push(Row { item, kind, tool, cases: 0, worst: 0.0, place: String::new() });
            self.rows.len() - 1
        });
        &mut self.rows[index]
    }

    /// Returns the rows, in the order in which their kinds first occurred.
    pub fn rows(self) -> Vec<Row> {
        self.rows
    }
}
