//! The number of cases of a long test, from an environment variable.

use std::env;
use std::ffi::OsStr;

/// Returns the number of cases to test: that of a variable, or `default` without it. Panics if the variable is no whole
/// number above 0: a typing error must not pass for a long run.
pub fn case_count(variable: &str, default: usize) -> usize {
    match count(env::var_os(variable).as_deref(), default) {
        Ok(count) => count,
        Err(text) => panic!("{variable} is `{text}`: give a whole number above 0"),
    }
}

/// Returns the number that a variable holds, or its text where it is none.
fn count(value: Option<&OsStr>, default: usize) -> Result<usize, String> {
    let Some(value) = value else { return Ok(default) };
    let number = value.to_str().and_then(|text| text.parse().ok());
    number.filter(|count| *count > 0).ok_or_else(|| value.to_string_lossy().into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_count_that_is_no_number_is_refused() {
        let counted = |text: &str| count(Some(OsStr::new(text)), 60);
        assert_eq!((count(None, 60), counted("1000")), (Ok(60), Ok(1000)));
        for wrong in ["", "0", "-1", "6O", "1e3", "60 ", "1_000", "99999999999999999999999"] {
            assert_eq!(counted(wrong), Err(wrong.to_owned()));
        }
    }
}
