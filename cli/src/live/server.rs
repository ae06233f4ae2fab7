//! A server on loopback of the page's files, which are built into the program (`web/dist`).
//!
//! It answers `GET` and `HEAD` of its own page only: the `Host` must be the address it listens at, so that no other
//! site's name leads here, and an `Origin` must be the page's own. Requests are at most `MAX_REQUEST` bytes long, without
//! a body, and must arrive within `TIMEOUT`.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::{self, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

const MAX_REQUEST: usize = 8192;
const MAX_HEADERS: usize = 64;
const MAX_CONNECTIONS: usize = 32;
const TIMEOUT: Duration = Duration::from_secs(10);

/// The headers of every answer. The page is isolated, so that its clock resolves microseconds.
const HEADERS: &str = "Connection: close\r\n\
    Cache-Control: no-store\r\n\
    X-Content-Type-Options: nosniff\r\n\
    Cross-Origin-Opener-Policy: same-origin\r\n\
    Cross-Origin-Embedder-Policy: require-corp\r\n\
    Cross-Origin-Resource-Policy: same-origin\r\n";

/// A file and its media type.
pub(super) struct Content {
    media_type: &'static str,
    bytes: Cow<'static, [u8]>,
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
    fn get(&self, path: &str) -> Option<&Content> {
        self.0.get(path)
    }
}

/// The reasons for which a request is not answered with a file.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Refusal {
    Malformed,
    Forbidden,
    NotFound,
    Method,
    TooLarge,
}

impl Refusal {
    fn status(self) -> &'static str {
        match self {
            Refusal::Malformed => "400 Bad Request",
            Refusal::Forbidden => "403 Forbidden",
            Refusal::NotFound => "404 Not Found",
            Refusal::Method => "405 Method Not Allowed",
            Refusal::TooLarge => "431 Request Header Fields Too Large",
        }
    }
}

/// Serves a page at the port of the listener, a thread per connection.
pub(super) fn serve(listener: &TcpListener, port: u16, page: Page) {
    let page = Arc::new(page);
    let connections = Arc::new(AtomicUsize::new(0));
    for stream in listener.incoming().flatten() {
        // Each connection has a thread; a page needs few at once.
        if connections.fetch_add(1, Ordering::Relaxed) >= MAX_CONNECTIONS {
            connections.fetch_sub(1, Ordering::Relaxed);
            continue;
        }
        let (page, connections) = (Arc::clone(&page), Arc::clone(&connections));
        std::thread::spawn(move || {
            // A browser that goes away in the middle is no failure.
            let _ = answer(stream, port, &page);
            connections.fetch_sub(1, Ordering::Relaxed);
        });
    }
}

/// Reads one request and answers it.
fn answer(mut stream: TcpStream, port: u16, page: &Page) -> io::Result<()> {
    stream.set_read_timeout(Some(TIMEOUT))?;
    stream.set_write_timeout(Some(TIMEOUT))?;
    let request = read_head(&mut stream)?;
    match request.as_deref().map_err(|refusal| *refusal).and_then(|head| find(head, port, page)) {
        Ok((content, with_body)) => {
            let Content { media_type, bytes } = content;
            let length = bytes.len();
            let head = format!(
                "HTTP/1.1 200 OK\r\nContent-Type: {media_type}\r\nContent-Length: {length}\r\n{HEADERS}\r\n"
            );
            stream.write_all(head.as_bytes())?;
            if with_body {
                stream.write_all(bytes)?;
            }
        }
        Err(refusal) => {
            let status = refusal.status();
            let length = status.len();
            let answer = format!(
                "HTTP/1.1 {status}\r\nContent-Type: text/plain\r\nContent-Length: {length}\r\n{HEADERS}\r\n{status}"
            );
            stream.write_all(answer.as_bytes())?;
        }
    }
    stream.flush()
}

/// Reads a request up to the end of its headers.
fn read_head(stream: &mut TcpStream) -> io::Result<Result<Vec<u8>, Refusal>> {
    let deadline = Instant::now() + TIMEOUT;
    let mut head = Vec::new();
    let mut buffer = [0; 1024];
    while !head.windows(4).any(|window| window == b"\r\n\r\n") {
        if head.len() > MAX_REQUEST || Instant::now() > deadline {
            return Ok(Err(Refusal::TooLarge));
        }
        match stream.read(&mut buffer)? {
            0 => return Ok(Err(Refusal::Malformed)),
            count => head.extend_from_slice(&buffer[..count]),
        }
    }
    Ok(Ok(head))
}

/// Returns the file that a request asks for, and whether it is to be sent.
fn find<'p>(head: &[u8], port: u16, page: &'p Page) -> Result<(&'p Content, bool), Refusal> {
    let mut headers = [httparse::EMPTY_HEADER; MAX_HEADERS];
    let mut request = httparse::Request::new(&mut headers);
    match request.parse(head) {
        Ok(httparse::Status::Complete(_)) => {}
        Ok(httparse::Status::Partial) => return Err(Refusal::Malformed),
        Err(httparse::Error::TooManyHeaders) => return Err(Refusal::TooLarge),
        Err(_) => return Err(Refusal::Malformed),
    }
    let own = ["127.0.0.1", "localhost"].map(|host| format!("{host}:{port}"));
    let is_own = |host: &[u8]| own.iter().any(|own| own.as_bytes() == host);
    let hosts: Vec<&[u8]> = values(request.headers, "host").collect();
    if !matches!(hosts[..], [host] if is_own(host)) {
        return Err(Refusal::Forbidden);
    }
    // Programs other than browsers state no origin.
    if !values(request.headers, "origin")
        .all(|origin| origin.strip_prefix(b"http://").is_some_and(is_own))
    {
        return Err(Refusal::Forbidden);
    }
    let with_body = match request.method {
        Some("GET") => true,
        Some("HEAD") => false,
        _ => return Err(Refusal::Method),
    };
    // Files are looked up by their whole path, so that none leads out of the page.
    let path = request.path.unwrap_or_default();
    let path = path.split_once('?').map_or(path, |(path, _)| path);
    page.get(path).map(|content| (content, with_body)).ok_or(Refusal::NotFound)
}

/// Returns the values of all headers with a name.
fn values<'h>(
    headers: &'h [httparse::Header<'h>],
    name: &'static str,
) -> impl Iterator<Item = &'h [u8]> {
    headers.iter().filter(move |one| one.name.eq_ignore_ascii_case(name)).map(|one| one.value)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn status(head: &str) -> Option<Refusal> {
        find(head.as_bytes(), 8080, &Page::embedded()).err()
    }

    #[test]
    fn only_the_own_page_is_served() {
        let get = |path: &str, headers: &str| {
            status(&format!("GET {path} HTTP/1.1\r\nHost: 127.0.0.1:8080\r\n{headers}\r\n"))
        };
        assert_eq!(get("/", ""), None);
        assert_eq!(get("/page.js?1", "Origin: http://127.0.0.1:8080\r\n"), None);
        assert_eq!(get("/", "Origin: http://example.com\r\n"), Some(Refusal::Forbidden));
        assert_eq!(get("/", "Origin: null\r\n"), Some(Refusal::Forbidden));
        assert_eq!(get("/", "Host: example.com\r\n"), Some(Refusal::Forbidden));
        for path in ["/nothing", "/../Cargo.toml", "//", "/index.html/..", "/part"] {
            assert_eq!(get(path, ""), Some(Refusal::NotFound), "{path}");
        }
        assert_eq!(get("/", &"A: b\r\n".repeat(70)), Some(Refusal::TooLarge));
        let host = |host: &str| status(&format!("GET / HTTP/1.1\r\nHost: {host}\r\n\r\n"));
        assert_eq!(host("localhost:8080"), None);
        for wrong in ["localhost", "127.0.0.1:80", "example.com:8080", "127.0.0.1:8080.example.com"]
        {
            assert_eq!(host(wrong), Some(Refusal::Forbidden), "{wrong}");
        }
        assert_eq!(status("GET / HTTP/1.1\r\n\r\n"), Some(Refusal::Forbidden));
        let post = "POST / HTTP/1.1\r\nHost: localhost:8080\r\n\r\n";
        assert_eq!(status(post), Some(Refusal::Method));
        assert_eq!(status("nonsense\r\n\r\n"), Some(Refusal::Malformed));
    }
}
