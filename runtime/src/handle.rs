//! Data that a query borrows or shares.

use std::ops::Deref;
use std::sync::Arc;

/// A reference to data that outlives the query, or a share of it.
pub(crate) enum Handle<'a, T: ?Sized> {
    Borrowed(&'a T),
    Shared(Arc<T>),
}

impl<T: ?Sized> Deref for Handle<'_, T> {
    type Target = T;

    #[inline]
    fn deref(&self) -> &T {
        match self {
            Handle::Borrowed(data) => data,
            Handle::Shared(data) => data,
        }
    }
}

// A derived implementation would ask for `T: Clone`.
impl<T: ?Sized> Clone for Handle<'_, T> {
    fn clone(&self) -> Self {
        match self {
            Handle::Borrowed(data) => Handle::Borrowed(data),
            Handle::Shared(data) => Handle::Shared(Arc::clone(data)),
        }
    }
}
