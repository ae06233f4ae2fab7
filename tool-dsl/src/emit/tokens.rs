//! An append-only list of tokens, so that tokens once written are never copied.

use proc_macro2::{Delimiter, Group, Ident, Literal, Punct, Spacing, Span, TokenStream};
use quote::{TokenStreamExt, quote};

/// The sizes of literals that need no exponent to be short.
const SIZES_WITHOUT_EXPONENT: std::ops::Range<f64> = 1e-5..1e16;

/// Code under construction.
#[derive(Default)]
pub(super) struct Tokens(TokenStream);

impl Tokens {
    pub(super) fn done(self) -> TokenStream {
        self.0
    }

    /// Appends a name or a keyword.
    pub(super) fn word(&mut self, word: &str) -> &mut Tokens {
        self.0.append(Ident::new(word, Span::call_site()));
        self
    }

    /// Appends an operator or other punctuation.
    pub(super) fn sign(&mut self, sign: &str) -> &mut Tokens {
        let mut rest = sign.chars().peekable();
        while let Some(char) = rest.next() {
            let spacing = if rest.peek().is_some() { Spacing::Joint } else { Spacing::Alone };
            self.0.append(Punct::new(char, spacing));
        }
        self
    }

    /// Appends a double as a literal that is parsed back to the same double.
    pub(super) fn number(&mut self, value: f64) -> &mut Tokens {
        let size = value.abs();
        if value.is_sign_negative() && size != 0.0 {
            self.sign("-");
        }
        let plain = size == 0.0 || SIZES_WITHOUT_EXPONENT.contains(&size);
        let literal = if plain { None } else { format!("{size:e}").parse().ok() };
        self.0.append(literal.unwrap_or_else(|| Literal::f64_unsuffixed(size)));
        self
    }

    /// Appends a group in parentheses.
    pub(super) fn paren(&mut self, inner: impl FnOnce(&mut Tokens)) -> &mut Tokens {
        self.group(Delimiter::Parenthesis, inner)
    }

    /// Appends a group in braces.
    pub(super) fn brace(&mut self, inner: impl FnOnce(&mut Tokens)) -> &mut Tokens {
        self.group(Delimiter::Brace, inner)
    }

    /// Appends a group in brackets.
    pub(super) fn bracket(&mut self, inner: impl FnOnce(&mut Tokens)) -> &mut Tokens {
        self.group(Delimiter::Bracket, inner)
    }

    fn group(&mut self, delimiter: Delimiter, inner: impl FnOnce(&mut Tokens)) -> &mut Tokens {
        let mut tokens = Tokens::default();
        inner(&mut tokens);
        self.0.append(Group::new(delimiter, tokens.0));
        self
    }

    /// Appends a call of one of `Lane`'s functions.
    pub(super) fn lane(&mut self, name: &str, inner: impl FnOnce(&mut Tokens)) -> &mut Tokens {
        self.word("L").sign("::").word(name).paren(inner)
    }

    /// Appends a test for any lane set in a mask.
    pub(super) fn any(&mut self, mask: impl FnOnce(&mut Tokens)) -> &mut Tokens {
        self.word("L").sign("::").word("any").paren(mask)
    }

    /// Appends a constant for all lanes.
    pub(super) fn of_lanes(&mut self, value: f64) -> &mut Tokens {
        self.word("z").sign(".").word("of").paren(|code| {
            code.number(value);
        })
    }
}

/// Returns a double as a literal, or infinity as its constant.
pub(super) fn literal(value: f64) -> TokenStream {
    if value == f64::INFINITY {
        return quote! { f64::INFINITY };
    }
    let mut tokens = Tokens::default();
    tokens.number(value);
    tokens.done()
}
