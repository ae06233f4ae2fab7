//! `Debug` for types that hold large memory or tools.

/// Implements `Debug` by some fields, those that tell one value from another.
macro_rules! debug {
    ([$($generics:tt)*] $type:ty, $name:literal, |$this:ident| { $($field:ident: $value:expr),+ $(,)? }) => {
        impl<$($generics)*> std::fmt::Debug for $type {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                let $this = self;
                f.debug_struct($name)
                    $(.field(stringify!($field), &$value))+
                    .finish_non_exhaustive()
            }
        }
    };
}

pub(crate) use debug;
