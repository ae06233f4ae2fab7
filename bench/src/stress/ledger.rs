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
    pub quantity: &'static str,
    /// The unit.
    pub unit: &'static str,
    /// The largest allowed value.
    pub limit: f64,
}

impl Kind {
    /// Makes a kind with a limit.
    pub const fn with_limit(quantity: &'static str, unit: &'static str, limit: f64) -> Kind {
        Kind { quantity, unit, limit }
    }

    /// Makes a kind of event that must not occur.
    pub const fn forbidden_event(quantity: &'static str) -> Kind {
        Kind { quantity, unit: "times", limit: 0.0 }
    }

    /// Makes a kind without a limit, for information.
    pub const fn informational(quantity: &'static str, unit: &'static str) -> Kind {
        Kind { quantity, unit, limit: f64::INFINITY }
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
    pub location: String,
}

impl Row {
    /// Returns whether the limit is exceeded.
    pub fn exceeds_limit(&self) -> bool {
        self.worst.is_nan() || self.worst > self.kind.limit
    }

    /// Returns the worst value divided by the limit; for events 0 or infinity.
    pub fn limit_fraction(&self) -> f64 {
        if self.worst == 0.0 { 0.0 } else { self.worst / self.kind.limit }
    }

    /// Returns a description of a missed limit.
    pub fn describe(&self) -> String {
        let Row { item, kind, tool, cases, worst, location } = self;
        let Kind { quantity, unit, limit } = kind;
        format!(
            "{} {tool}: {quantity} {worst:.3e} {unit} > {limit}, of {cases}, at {location}",
            item.0
        )
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
    pub fn record(&mut self, kind: Kind, value: f64, location: impl FnOnce() -> String) {
        let row = self.row(kind);
        row.cases += 1;
        let value = if value.is_nan() { f64::INFINITY } else { value };
        if value > row.worst {
            row.worst = value;
            row.location = location();
        }
    }

    /// Records a case, and whether the event occurred.
    pub fn count(&mut self, kind: Kind, occurred: bool, location: impl FnOnce() -> String) {
        let row = self.row(kind);
        row.cases += 1;
        if occurred {
            if row.worst == 0.0 {
                row.location = location();
            }
            row.worst += 1.0;
        }
    }

    /// Records `cases` cases of a kind without a limit.
    pub fn record_info(&mut self, kind: Kind, cases: usize, value: f64, location: &str) {
        let row = self.row(kind);
        row.cases += cases;
        if value > row.worst || row.location.is_empty() {
            row.worst = row.worst.max(value);
            location.clone_into(&mut row.location);
        }
    }

    fn row(&mut self, kind: Kind) -> &mut Row {
        let existing = self.rows.iter().position(|row| row.kind == kind);
        let index = existing.unwrap_or_else(|| {
            let (item, tool) = (self.item, self.tool.clone());
            self.rows.push(Row { item, kind, tool, cases: 0, worst: 0.0, location: String::new() });
            self.rows.len() - 1
        });
        &mut self.rows[index]
    }

    /// Returns the rows, in the order in which their kinds first occurred.
    pub fn rows(self) -> Vec<Row> {
        self.rows
    }
}
