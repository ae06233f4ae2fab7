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
    pub(super) fn joined(parts: Vec<Lists>) -> Lists {
        let [items, lists] = parts.iter().fold([0; 2], |[items, lists], part| {
            [items + part.items.len(), lists + part.ends.len()]
        });
        let mut combined =
            Lists { items: Vec::with_capacity(items), ends: Vec::with_capacity(lists) };
        for Lists { items, ends } in parts {
            let offset = combined.items.len();
            combined.items.extend(items);
            combined.ends.extend(ends.into_iter().map(|end| offset + end));
        }
        combined
    }

    /// Returns the list at index `index`.
    pub(super) fn of(&self, index: u32) -> &[u32] {
        let index = index as usize;
        let start = if index == 0 { 0 } else { self.ends[index - 1] };
        &self.items[start..self.ends[index]]
    }
}
