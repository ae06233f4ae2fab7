//! Progress bars on standard error.

use indicatif::{ProgressBar, ProgressStyle};
use std::time::Duration;

/// A progress bar, cleared when it is dropped. It shows only on a terminal, and never with `--json`.
pub(crate) struct Progress(ProgressBar);

impl Progress {
    /// Creates a bar that counts `steps`, such as poses.
    pub(crate) fn steps(count: usize, steps: &str, json: bool) -> Progress {
        if json {
            return Progress::hidden();
        }
        let template = format!("{{wide_bar}} {{pos}}/{{len}} {steps} {{eta}} left");
        Progress(ProgressBar::new(count as u64).with_style(style(&template)))
    }

    /// Creates a spinner with the elapsed time, for work of unknown length.
    pub(crate) fn spinner(message: &'static str, json: bool) -> Progress {
        if json {
            return Progress::hidden();
        }
        let bar = ProgressBar::new_spinner().with_style(style("{spinner} {msg}, {elapsed}"));
        bar.enable_steady_tick(Duration::from_millis(100));
        Progress(bar.with_message(message))
    }

    /// Returns a bar that is never shown.
    fn hidden() -> Progress {
        Progress(ProgressBar::hidden())
    }

    /// Counts steps that are done.
    pub(crate) fn advance(&self, steps: usize) {
        self.0.inc(steps as u64);
    }

    /// Clears the bar while `print` writes lines.
    pub(crate) fn suspend<R>(&self, print: impl FnOnce() -> R) -> R {
        self.0.suspend(print)
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}

fn style(template: &str) -> ProgressStyle {
    ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar())
}
