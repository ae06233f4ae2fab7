//! The files of the page, built into the program (`web/dist`).

use std::borrow::Cow;
use std::collections::BTreeMap;

/// A file and its media type.
pub(super) struct Content {
    pub(super) media_type: &'static str,
    pub(super) bytes: Cow<'static, [u8]>,
}

impl Content {
    /// Returns a JSON file.
    pub(super) fn json(bytes: Vec<u8>) -> Content {
        Content { media_type: "application/json", bytes: bytes.into() }
    }

    /// Returns a file of bytes.
    pub(super) fn bytes(bytes: Vec<u8>) -> Content {
        Content { media_type: "application/octet-stream", bytes: bytes.into() }
    }
}

/// All files by their path; nothing else is served.
pub(super) struct Page(BTreeMap<&'static str, Content>);

macro_rules! file {
    ($name:literal, $media_type:literal) => {
        Content {
            media_type: $media_type,
            bytes: Cow::Borrowed(include_bytes!(concat!("../../../web/dist/", $name))),
        }
    };
}

impl Page {
    /// Returns the files that are built into the program.
    pub(super) fn embedded() -> Page {
        Page(BTreeMap::from([
            ("/", file!("index.html", "text/html; charset=utf-8")),
            ("/page.css", file!("page.css", "text/css; charset=utf-8")),
            ("/page.js", file!("page.js", "text/javascript; charset=utf-8")),
            ("/checker.js", file!("checker.js", "text/javascript; charset=utf-8")),
            ("/worker.js", file!("worker.js", "text/javascript; charset=utf-8")),
            ("/engine.js", file!("engine.js", "text/javascript; charset=utf-8")),
            ("/engine.wasm.gz", file!("engine.wasm.gz", "application/octet-stream")),
        ]))
    }

    /// Adds or replaces a file.
    pub(super) fn add(&mut self, path: &'static str, content: Content) {
        self.0.insert(path, content);
    }

    /// Returns the file of a path, if there is one.
    pub(super) fn get(&self, path: &str) -> Option<&Content> {
        self.0.get(path)
    }
}
