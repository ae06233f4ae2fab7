//! Data that a query borrows or shares.

use crate::tool::Tool;
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

/// The same for a tool of any type. A tool that is shared borrows nothing, so that a query that borrows its tool may be
/// declared before it.
#[derive(Clone)]
pub(crate) enum ToolHandle<'a> {
    Borrowed(&'a dyn Tool),
    Shared(Arc<dyn Tool>),
}

impl<'a> Deref for ToolHandle<'a> {
    type Target = dyn Tool + 'a;

    #[inline]
    fn deref(&self) -> &(dyn Tool + 'a) {
        match self {
            ToolHandle::Borrowed(tool) => *tool,
            ToolHandle::Shared(tool) => &**tool,
        }
    }
}
