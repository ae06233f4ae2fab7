//! `touchoff live`: the page and nothing else, to nobody but this machine.

use crate::bench::{Bench, touchoff};
use serde_json::Value;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::{Child, Command, Stdio};

/// A server that ends with the test.
struct Live {
    program: Child,
    port: u16,
}

impl Live {
    fn new(bench: &Bench, arguments: &[&str]) -> Live {
        let mut program = Command::new(env!("CARGO_BIN_EXE_touchoff"));
        program.args(["live", "--no-open", "--json"]).args(arguments);
        program.current_dir(&bench.folder).stdout(Stdio::piped()).stderr(Stdio::null());
        let mut program = program.spawn().expect("the program runs");
        let mut line = String::new();
        let stdout = program.stdout.take().expect("a pipe");
        BufReader::new(stdout).read_line(&mut line).expect("a line");
        let row: Value = serde_json::from_str(&line).expect("an object");
        let address = row["address"].as_str().expect("an address").to_owned();
        let port = address.trim_start_matches("http://127.0.0.1:").trim_end_matches('/');
        Live { program, port: port.parse().expect("a port") }
    }

    /// Returns status, headers and body of the answer to a request.
    fn ask(&self, request: &str) -> (u16, String, Vec<u8>) {
        let mut stream = TcpStream::connect(("127.0.0.1", self.port)).expect("a server");
        // A server that has refused may close before all is sent.
        let _ = stream.write_all(request.as_bytes());
        let mut answer = Vec::new();
        let _ = stream.read_to_end(&mut answer);
        let end = answer.windows(4).position(|window| window == b"\r\n\r\n").expect("headers");
        let head = String::from_utf8(answer[..end].to_vec()).expect("text");
        let status = head.split(' ').nth(1).expect("a status").parse().expect("a number");
        (status, head, answer[end + 4..].to_vec())
    }

    fn get(&self, path: &str) -> (u16, String, Vec<u8>) {
        self.ask(&format!("GET {path} HTTP/1.1\r\nHost: 127.0.0.1:{}\r\n\r\n", self.port))
    }
}

impl Drop for Live {
    fn drop(&mut self) {
        let _ = self.program.kill();
        let _ = self.program.wait();
    }
}

#[test]
fn the_page_comes_with_the_part_and_the_tool() {
    let bench = Bench::new();
    bench.write(
        "holder.tool",
        "tool Nut { units mm; profile { start (0, 0); line to (9, 0), (9, 5), (0, 5) as nut; } }",
    );
    bench.write(
        "my.tool",
        "tool My { units mm; mount \"cutter.tool\" as cutter; mount \"holder.tool\" as nut at z = 12; }",
    );
    bench.write(
        "cutter.tool",
        "tool Cutter { units mm; profile { start (0, 0); arc to (2, 2) center (0, 2) as ball cutting; \
         line to (2, 15), (0, 15) as shank; } niceness cutting: 1; }",
    );
    let program = "G21 G90 G43 H1\nG0 X0. Y0. Z20.\nG1 Z15. F100.\nM30\n";
    bench.write("part.nc", program);
    let live = Live::new(
        &bench,
        &["--part", "block.stl", "--unit", "inch", "--tool", "my.tool", "--program", "part.nc"],
    );
    let (status, head, page) = live.get("/");
    assert_eq!(status, 200);
    assert!(head.contains("Cross-Origin-Opener-Policy: same-origin"), "{head}");
    assert!(String::from_utf8_lossy(&page).contains("<title>Touchoff live</title>"));
    for file in
        ["/page.js", "/checker.js", "/worker.js", "/engine.js", "/engine.wasm.gz", "/page.css"]
    {
        let (status, _, bytes) = live.get(file);
        assert!(status == 200 && bytes.len() > 1000, "{file}: {status}, {} bytes", bytes.len());
    }
    let begin: Value = serde_json::from_slice(&live.get("/session.json").2).expect("an object");
    assert_eq!(begin["part"], serde_json::json!({"name": "block.stl", "unit": "inch"}));
    let tool = &begin["tools"][0];
    assert_eq!((&tool["name"], &tool["number"]), (&"my.tool".into(), &Value::Null));
    assert!(tool["text"].as_str().expect("a text").contains("tool My"));
    let files = tool["files"].as_object().expect("files");
    assert_eq!(files.keys().collect::<Vec<_>>(), ["cutter.tool", "holder.tool"]);
    let block = std::fs::read(bench.folder.path().join("block.stl")).expect("the part");
    assert_eq!(live.get("/part").2, block);
    let begun = serde_json::json!({"name": "part.nc", "machine": {"name": "3-axis", "text": null}});
    assert_eq!(begin["program"], begun);
    assert_eq!(live.get("/program").2, program.as_bytes());
    // A head has no body.
    let head = format!("HEAD / HTTP/1.1\r\nHost: localhost:{}\r\n\r\n", live.port);
    let (status, _, body) = live.ask(&head);
    assert_eq!((status, body.len()), (200, 0));
}

#[test]
fn nothing_else_is_served_and_nobody_else() {
    let bench = Bench::new();
    let live = Live::new(&bench, &["--tool", "1=BallEr16,12=D2Ball"]);
    let begin: Value = serde_json::from_slice(&live.get("/session.json").2).expect("an object");
    let tools = [(1, "ball_er16.tool"), (12, "d2_ball.tool")].map(|(number, name)| {
        serde_json::json!({"number": number, "name": name, "text": null, "files": {}})
    });
    assert_eq!(begin["tools"], serde_json::json!(tools));
    assert!(begin["part"].is_null());
    for path in ["/part", "/block.stl", "/../block.stl", "/%2e%2e/block.stl", "/etc/passwd"] {
        assert_eq!(live.get(path).0, 404, "{path}");
    }
    let port = live.port;
    let status = |request: String| live.ask(&request).0;
    assert_eq!(status(format!("GET / HTTP/1.1\r\nHost: example.com:{port}\r\n\r\n")), 403);
    let own = format!("Host: 127.0.0.1:{port}\r\n");
    assert_eq!(status(format!("GET / HTTP/1.1\r\n{own}Origin: http://example.com\r\n\r\n")), 403);
    assert_eq!(status(format!("POST / HTTP/1.1\r\n{own}Content-Length: 3\r\n\r\nabc")), 405);
    assert_eq!(status(format!("GET / HTTP/1.1\r\n{own}A: {}\r\n\r\n", "b".repeat(20_000))), 431);
    assert_eq!(status("nonsense\r\n\r\n".to_owned()), 400);
    assert_eq!(live.get("/").0, 200);
}

#[test]
fn wrong_parts_and_tools_are_refused() {
    let bench = Bench::new();
    let refused = |arguments: &[&str], status: i32, word: &str| {
        let output = touchoff(&[&["live", "--no-open"], arguments].concat());
        let said = crate::bench::stderr(&output);
        assert!(
            output.status.code() == Some(status) && said.contains(word),
            "{arguments:?}: {said}"
        );
    };
    let broken = bench.write("broken.tool", "tool Broken { units mm; }");
    let part = bench.write("empty.stl", "");
    refused(&["--tool", &broken], 1, "broken.tool");
    refused(&["--tool", "D2Bal"], 1, "did you mean `D2Ball`?");
    refused(&["--tool", "1=D2Bal"], 1, "did you mean `D2Ball`?");
    for tools in ["D2Ball,BallEr16", "1=D2Ball,BallEr16", "1=D2Ball,1=BallEr16"] {
        refused(&["--tool", tools], 2, "each has a number of its own");
    }
    refused(&["--part", &part, "--unit", "mm"], 1, "empty.stl");
    let program = bench.write("bad.nc", "G21 G90\nG1 X#1 F100.\n");
    refused(&["--program", &program], 2, "bad.nc:2");
    refused(&["--program", &program, "--machine", "9-axis"], 2, "9-axis");
    let table = bench.write("table.csv", "0,0,9,0,0,1\n");
    refused(
        &["--program", &table, "--machine", "3-axis"],
        2,
        "a machine or a control is for G-code",
    );
    refused(&["--part", &part], 2, "--unit");
    let taken = std::net::TcpListener::bind("127.0.0.1:0").expect("a port");
    let port = taken.local_addr().expect("an address").port().to_string();
    refused(&["--port", &port], 1, "another `--port`");
}
