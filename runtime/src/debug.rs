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

/// Implements `Debug` of an error by its sentence, since that is what `main` prints of an error that it returns.
#[doc(hidden)]
#[macro_export]
macro_rules! debug_as_sentence {
    ($error:ty) => {
        impl std::fmt::Debug for $error {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                std::fmt::Display::fmt(self, f)
            }
        }
    };
}
