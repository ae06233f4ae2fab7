//! Progress on standard error: a bar on a terminal, lines elsewhere.

use indicatif::{ProgressBar, ProgressStyle};
use std::io::{IsTerminal, Write, stderr};
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// The progress of some work: on a terminal a bar that is cleared when it is dropped, elsewhere a line every ten seconds. With
/// `--json` nothing is shown.
pub(crate) struct Progress {
    bar: ProgressBar,
    lines: Option<Lines>,
}

/// Time between two lines.
const LINE_INTERVAL: Duration = Duration::from_secs(10);

/// The lines of progress where no bar can be shown.
struct Lines {
    count: usize,
    /// The name of the steps.
    steps: String,
    start: Instant,
    /// Time of the next line since the start.
    next: Mutex<Duration>,
}

impl Progress {
    /// Counts `steps`, such as poses.
    pub(crate) fn steps(count: usize, steps: &str, json: bool) -> Progress {
        if json {
            return Progress::hidden();
        }
        let template = format!("{{wide_bar}} {{pos}}/{{len}} {steps} {{eta}} left");
        let lines = (!stderr().is_terminal()).then(|| Lines::new(count, steps));
        Progress { bar: ProgressBar::new(count as u64).with_style(style(&template)), lines }
    }

    /// Shows a spinner with the elapsed time on a terminal, for work of unknown length.
    pub(crate) fn spinner(message: &'static str, json: bool) -> Progress {
        if json {
            return Progress::hidden();
        }
        let bar = ProgressBar::new_spinner().with_style(style("{spinner} {msg}, {elapsed}"));
        bar.enable_steady_tick(Duration::from_millis(100));
        Progress { bar: bar.with_message(message), lines: None }
    }

    /// Returns progress that is never shown.
    fn hidden() -> Progress {
        Progress { bar: ProgressBar::hidden(), lines: None }
    }

    /// Counts steps that are done.
    pub(crate) fn advance(&self, steps: usize) {
        self.bar.inc(steps as u64);
        let lines = self.lines.as_ref();
        if let Some(line) =
            lines.and_then(|lines| lines.due(self.bar.position(), lines.start.elapsed()))
        {
            // Progress that nobody can read is no reason to stop.
            let _ = writeln!(stderr(), "{line}");
        }
    }

    /// Clears the bar while `print` writes lines.
    pub(crate) fn suspend<R>(&self, print: impl FnOnce() -> R) -> R {
        self.bar.suspend(print)
    }
}

impl Lines {
    fn new(count: usize, steps: &str) -> Lines {
        let (steps, start) = (steps.to_owned(), Instant::now());
        Lines { count, steps, start, next: Mutex::new(LINE_INTERVAL) }
    }

    /// Returns the line that is due when some steps are done at a time since the start.
    fn due(&self, done: u64, elapsed: Duration) -> Option<String> {
        // The first of several threads writes the line.
        let mut next = self.next.try_lock().ok()?;
        if elapsed < *next {
            return None;
        }
        *next = elapsed + LINE_INTERVAL;
        let Lines { count, steps, .. } = self;
        Some(format!("{done} of {count} {steps} after {} s", elapsed.as_secs()))
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

fn style(template: &str) -> ProgressStyle {
    ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_due_every_ten_seconds() {
        let lines = Lines::new(200, "motions");
        let due = |done, seconds| lines.due(done, Duration::from_secs(seconds));
        assert_eq!(due(5, 9), None);
        assert_eq!(due(7, 12).as_deref(), Some("7 of 200 motions after 12 s"));
        assert_eq!(due(80, 21), None);
        assert_eq!(due(90, 40).as_deref(), Some("90 of 200 motions after 40 s"));
        assert_eq!(due(91, 49), None);
    }
}
