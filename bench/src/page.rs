//! Pages of measurements: a head line with commit, command, machine and covered paths, and sections with figures.

use std::io;
use std::path::{Path, PathBuf};
use std::process::Command;
use touchoff::AtomicFile;

/// The digests of the Rust of all tools, which a test compares with the compiler's output. Figures of generated code change
/// with them, and not with the compiler's sources.
pub const GENERATED_CODE: &str = "tests/tests/compiler/snapshots/compiler__generated__digests.snap";

/// A page of measurements and the files that belong to it.
#[derive(Clone, Debug, Default)]
pub struct Page {
    /// The file name in `docs/measured`, without extension.
    pub name: &'static str,
    /// The title.
    pub title: &'static str,
    /// The paths in the repository that the measurements depend on.
    pub covers: &'static [&'static str],
    /// The sections below the head line, in order.
    pub sections: Vec<Section>,
    /// The drawings: file names and contents.
    pub figures: Vec<(String, String)>,
}

/// A section of a page.
#[derive(Clone, Debug, Default)]
pub struct Section {
    /// The heading; empty for text directly under the page's title.
    pub title: &'static str,
    /// The Markdown below the heading.
    pub body: String,
}

impl Page {
    /// Returns the path of the page in a folder.
    pub fn path(&self, folder: &Path) -> PathBuf {
        folder.join(format!("{}.md", self.name))
    }

    /// Writes the page and its figures into a folder, which is created if it does not exist. `command` is the command
    /// line to state in the head line.
    ///
    /// # Errors
    /// If the folder or a file cannot be written.
    pub fn write(&self, folder: &Path, command: &str) -> io::Result<()> {
        std::fs::create_dir_all(folder)?;
        let mut text = format!("# {}\n\n{}\n", self.title, head_line(command, self.covers));
        for Section { title, body } in &self.sections {
            if !title.is_empty() {
                text += &format!("\n## {title}\n");
            }
            text += &format!("\n{}\n", body.trim());
        }
        AtomicFile::write(self.path(folder), text)?;
        for (name, content) in &self.figures {
            AtomicFile::write(folder.join(name), content)?;
        }
        Ok(())
    }
}

/// Returns the head line of a page: the commit, the `command`, the machine, and the repository paths that the
/// measurements depend on. A commit ends with `-dirty` if the working tree differs from it.
fn head_line(command: &str, covers: &[&str]) -> String {
    let git = Command::new("git").args(["describe", "--always", "--dirty", "--exclude=*"]).output();
    let commit = git.ok().and_then(|output| String::from_utf8(output.stdout).ok());
    let commit = commit.unwrap_or_default();
    let cpus = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = cpus.lines().find_map(|line| line.strip_prefix("model name")?.split_once(": "));
    let model = model.map_or("an unknown processor", |(_, model)| model);
    let cores = match std::thread::available_parallelism().map_or(1, usize::from) {
        1 => "1 core".to_owned(),
        several => format!("{several} cores"),
    };
    let covers = covers.iter().map(|path| format!("`{path}`")).collect::<Vec<_>>().join(", ");
    format!(
        "*Made at commit {} by `{command}` on {cores} of {model}; covers {covers}.*",
        commit.trim()
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn measured_pages_are_few_and_small_and_name_a_commit() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/measured");
        let entries = std::fs::read_dir(folder).expect("the folder of pages");
        let mut pages = 0;
        let mut bytes = 0;
        for entry in entries {
            let path = entry.expect("a file").path();
            bytes += path.metadata().expect("a file").len();
            if path.extension().is_some_and(|end| end == "md") {
                pages += 1;
                let text = std::fs::read_to_string(&path).expect("a page");
                let head = text.lines().nth(2).unwrap_or_default();
                let rest = head.strip_prefix("*Made at commit ").unwrap_or_default();
                let (commit, rest) = rest.split_once(" by `").unwrap_or_default();
                assert!(
                    commit.len() >= 7 && commit.bytes().all(|byte| byte.is_ascii_hexdigit()),
                    "{}: {head}",
                    path.display()
                );
                assert!(rest.contains("; covers `"), "{}: {head}", path.display());
            }
        }
        assert!(0 < pages && pages <= 6, "{pages} pages");
        assert!(bytes < 1_000_000, "{bytes} bytes");
    }

    #[test]
    fn writes_title_head_line_sections_and_figures() {
        let folder = tempfile::tempdir().expect("a folder");
        let sections = [("", "\nAll of them.\n\n"), ("Proofs", "By hand.")];
        let section =
            |(title, body): (&'static str, &str)| Section { title, body: body.to_owned() };
        let page = Page {
            name: "sums",
            title: "Sums",
            covers: &["runtime/src", "tool-dsl/src"],
            sections: sections.map(section).into(),
            figures: vec![("sums.svg".to_owned(), "<svg/>".to_owned())],
        };
        page.write(folder.path(), "sum --all").expect("a writable folder");
        let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).expect("a file");
        let text = read("sums.md");
        let lines: Vec<&str> = text.split('\n').collect();
        let [title, "", head, "", body, "", "## Proofs", "", "By hand.", ""] = lines[..] else {
            panic!("{text}")
        };
        assert_eq!((title, body, read("sums.svg").as_str()), ("# Sums", "All of them.", "<svg/>"));
        assert!(
            head.starts_with("*Made at commit ") && head.contains(" by `sum --all` on "),
            "{head}"
        );
        assert!(head.ends_with("; covers `runtime/src`, `tool-dsl/src`.*"), "{head}");
    }
}
