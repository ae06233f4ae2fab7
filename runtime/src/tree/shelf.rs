//! A list that a tree owns, or has in a file that lies in memory.

use bytemuck::Pod;
use memmap2::Mmap;
use std::fmt;
use std::ops::{Deref, Range};
use std::sync::Arc;
use yoke::Yoke;

/// A list, wherever it lies. Which of the two it is is asked once for each time that it is taken
/// for a slice: a hot loop takes the slice before it begins.
#[derive(Clone)]
pub(crate) struct Shelf<T: 'static>(Place<T>);

#[derive(Clone)]
enum Place<T: 'static> {
    Own(Vec<T>),
    Mapped(Yoke<&'static [T], Arc<Mmap>>),
}

impl<T> Deref for Shelf<T> {
    type Target = [T];

    #[inline(always)]
    fn deref(&self) -> &[T] {
        match &self.0 {
            Place::Own(list) => list,
            Place::Mapped(list) => list.get(),
        }
    }
}

impl<T: Pod> Shelf<T> {
    /// Those bytes of a map; `None` if they are not there, lie askew or are no whole number of `T`.
    pub(crate) fn mapped(map: &Arc<Mmap>, bytes: Range<usize>) -> Option<Shelf<T>> {
        let list = Yoke::try_attach_to_cart(Arc::clone(map), |map| {
            let bytes = map.get(bytes).ok_or(())?;
            bytemuck::try_cast_slice(bytes).map_err(|_| ())
        });
        list.ok().map(|list| Shelf(Place::Mapped(list)))
    }

    /// The list to be changed; what lies in a file is copied first, and the file stays.
    pub(crate) fn to_mut(&mut self) -> &mut [T] {
        if let Place::Mapped(list) = &self.0 {
            self.0 = Place::Own(list.get().to_vec());
        }
        match &mut self.0 {
            Place::Own(list) => list,
            Place::Mapped(_) => unreachable!("it was copied"),
        }
    }
}

impl<T> From<Vec<T>> for Shelf<T> {
    fn from(list: Vec<T>) -> Shelf<T> {
        Shelf(Place::Own(list))
    }
}

impl<T> FromIterator<T> for Shelf<T> {
    fn from_iter<I: IntoIterator<Item = T>>(items: I) -> Shelf<T> {
        Shelf::from(Vec::from_iter(items))
    }
}

impl<T: fmt::Debug> fmt::Debug for Shelf<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(&**self).finish()
    }
}
