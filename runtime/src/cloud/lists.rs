//! Many short lists in one allocation.

/// Consecutive lists of indices, in one vector.
#[derive(Default)]
pub(super) struct Lists {
    items: Vec<u32>,
    /// The end of each list in `items`.
    ends: Vec<usize>,
}

impl Lists {
    /// Appends to the last list.
    pub(super) fn push(&mut self, item: u32) {
        self.items.push(item);
    }

    /// Ends the last list and begins another.
    pub(super) fn end(&mut self) {
        self.ends.push(self.items.len());
    }

    /// Concatenates several collections of lists, in order.
    pub(super) fn joined(some: Vec<Lists>) -> Lists {
        let [items, lists] = some.iter().fold([0; 2], |[items, lists], some| {
            [items + some.items.len(), lists + some.ends.len()]
        });
        let mut all = Lists { items: Vec::with_capacity(items), ends: Vec::with_capacity(lists) };
        for Lists { items, ends } in some {
            let before = all.items.len();
            all.items.extend(items);
            all.ends.extend(ends.into_iter().map(|end| before + end));
        }
        all
    }

    /// Returns the list at index `place`.
    pub(super) fn of(&self, place: u32) -> &[u32] {
        let place = place as usize;
        let start = if place == 0 { 0 } else { self.ends[place - 1] };
        &self.items[start..self.ends[place]]
    }
}
