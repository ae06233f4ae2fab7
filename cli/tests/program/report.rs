//! Reports: one HTML file with every finding, which loads nothing and survives the names of files.

use crate::bench::{Bench, Gouging, findings, shared, stderr};
use crate::job::bracket;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::Value;
use std::process::Output;
use touchoff::mesh::shapes;
use touchoff::{Mesh, Unit};

/// Largest size of a report, in bytes.
const MAX_BYTES: usize = 15_000_000;

/// A report as it was written.
struct Page {
    text: String,
    output: Output,
}

impl Page {
    /// Writes a report into the folder of a bench.
    fn write(bench: &Bench, arguments: &str) -> Page {
        let output = bench.touchoff(&format!("report {arguments} -o report.html"));
        let text = std::fs::read_to_string(bench.place("report.html"));
        let text = text.unwrap_or_else(|error| panic!("{error}: {}", stderr(&output)));
        assert!(text.len() < MAX_BYTES, "{} bytes", text.len());
        Page { text, output }
    }

    /// Returns the JSON of a script element, which ends where a browser ends it.
    fn data(&self, id: &str) -> Value {
        let start = format!("<script type=\"application/json\" id=\"{id}\">");
        let (_, rest) = self.text.split_once(&start).expect("the element");
        let (json, _) = rest.split_once("</script").expect("its end");
        assert!(!json.contains("<!--") && !json.contains("<script"), "{id} changes the parser");
        serde_json::from_str(json).expect("JSON")
    }

    /// Returns the rows of the table of findings.
    fn rows(&self) -> Vec<&str> {
        let Some((_, table)) = self.text.split_once("<table class=\"findings\">") else {
            return Vec::new();
        };
        let (table, _) = table.split_once("</table>").expect("its end");
        table.split("<tr id=\"finding-").skip(1).collect()
    }

    /// Returns the parts between two marks.
    fn between(&self, start: &str, end: &str) -> Vec<&str> {
        let parts = self.text.split(start).skip(1);
        parts.map(|part| part.split_once(end).expect("an end").0).collect()
    }
}

/// Asserts that nothing in a page is loaded from elsewhere.
fn assert_self_contained(page: &Page) {
    assert!(page.text.contains("content=\"default-src 'none'; img-src data:;"), "no policy");
    assert!(!page.text.contains("unsafe-"), "a policy with exceptions");
    for word in
        ["http:", "https:", "//www", "@import", "url(", "fetch(", "XMLHttpRequest", "import("]
    {
        assert!(!page.text.contains(word), "{word}");
    }
    for source in page.between(" src=\"", "\"") {
        assert!(source.starts_with("data:image/"), "{source}");
    }
    for link in page.between(" href=\"", "\"") {
        assert!(link.starts_with("#finding-"), "{link}");
    }
    for drawing in page.between("data:image/svg+xml;base64,", "\"") {
        let drawing = STANDARD.decode(drawing).expect("base64");
        let drawing = String::from_utf8(drawing).expect("UTF-8");
        let others = drawing.replace("http://www.w3.org/2000/svg", "");
        assert!(!others.contains("http") && !others.contains("href"), "{others}");
    }
}

/// Returns the numbers of a list.
fn numbers(list: &Value) -> Vec<f64> {
    let list = list.as_array().expect("a list");
    list.iter().map(|number| number.as_f64().expect("a number")).collect()
}

/// Returns the vertices and triangles of a body of the 3-D view.
fn body(body: &Value) -> (Vec<[f64; 3]>, Vec<[usize; 3]>) {
    let bytes = |key: &str| STANDARD.decode(body[key].as_str().expect("a text")).expect("base64");
    let (low, step) = (numbers(&body["low"]), numbers(&body["step"]));
    let vertices = bytes("vertices");
    let vertices = vertices.chunks(6).map(|six| {
        [0, 1, 2].map(|k| {
            let steps = u16::from_le_bytes([six[2 * k], six[2 * k + 1]]);
            low[k] + f64::from(steps) * step[k]
        })
    });
    let triangles = bytes("triangles");
    let triangles = triangles.chunks(12).map(|twelve| {
        let at = |k: usize| twelve[4 * k..4 * k + 4].try_into().expect("four bytes");
        [0, 1, 2].map(|k| u32::from_le_bytes(at(k)) as usize)
    });
    (vertices.collect(), triangles.collect())
}

fn area([a, b, c]: [[f64; 3]; 3]) -> f64 {
    let [u, v] = [b, c].map(|end| [0, 1, 2].map(|k| end[k] - a[k]));
    let cross =
        [0, 1, 2].map(|k| u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3]);
    0.5 * cross.iter().map(|part| part * part).sum::<f64>().sqrt()
}

/// Asserts that a report has the findings that `verify` prints, and a camera on each that has a pose.
fn assert_same_findings(page: &Page, verified: &Output) {
    assert_eq!(page.output.status.code(), verified.status.code(), "{}", stderr(&page.output));
    let rows = findings(verified);
    assert_eq!(page.data("findings"), Value::from(rows.clone()));
    let (shown, scene) = (page.rows(), page.data("scene"));
    assert_eq!(shown.len(), rows.len());
    for ((row, shown), place) in
        rows.iter().zip(shown).zip(scene["places"].as_array().expect("a list"))
    {
        assert!(shown.contains(&format!("<td class=\"number\">{}</td>", row["line"])), "{shown}");
        assert_eq!(row.get("tip"), place.get("tip"), "{row}");
        if let (Some(point), Some(_)) = (row.get("point"), place.get("target")) {
            assert_eq!(point, &place["target"]);
        }
        assert_eq!(shown.contains("<button"), !place.is_null(), "{shown}");
    }
}

#[test]
fn every_finding_has_a_row_and_a_camera() {
    let bench = Bench::new();
    let Gouging { part, program } = bench.gouging();
    let options = format!("--unit mm --tool D2Ball --program {program} --tolerance 0.01");
    let page = Page::write(&bench, &format!("{part} {options}"));
    let verified = bench.touchoff(&format!("verify --part {part} --json {options}"));
    assert_same_findings(&page, &verified);
    assert_self_contained(&page);

    // The text of each finding, as `verify` prints it after file and line.
    let printed = bench.touchoff(&format!("verify --part {part} {options}"));
    let printed = String::from_utf8(printed.stdout).expect("UTF-8");
    assert!(printed.lines().count() > 0);
    for (line, row) in printed.lines().zip(page.rows()) {
        let (_, text) = line.split_once(": ").expect("a file and a line");
        let (text, code) = text.rsplit_once(" [").expect("a code");
        assert!(row.contains(text), "{text} is not in {row}");
        assert!(row.contains(&format!("title=\"{}\"", code.trim_end_matches(']'))), "{row}");
    }
    assert!(page.text.contains("<strong>findings: 3 violations</strong>"), "{}", page.rows().len());

    // The part in the 3-D view is the tube, divided into smaller triangles.
    let scene = page.data("scene");
    let (vertices, triangles) = body(&scene["bodies"][0]);
    let shown: f64 = triangles.iter().map(|ends| area(ends.map(|end| vertices[end]))).sum();
    let tube = touchoff::scenes::tube();
    let all: f64 = tube.ids().map(|id| tube.area(id)).sum();
    assert!((shown / all - 1.0).abs() < 1e-3, "{shown} instead of {all}");
    for [x, y, _] in &vertices {
        assert!((2.98..5.001).contains(&x.hypot(*y)), "{x} {y}");
    }
    // Colours lie where the cutter passes, on the outer wall about its height, and nowhere else.
    let values = scene["layers"][0]["values"].as_str().expect("a text");
    let values = STANDARD.decode(values).expect("base64");
    assert_eq!(values.len(), triangles.len());
    let coloured = || triangles.iter().zip(&values).filter(|(_, value)| **value > 0);
    assert!(coloured().count() > 100);
    for (ends, _) in coloured() {
        let radius = |end: &usize| vertices[*end][0].hypot(vertices[*end][1]);
        assert!(ends.iter().map(radius).fold(0.0, f64::max) > 4.8, "{ends:?}");
    }
    // The deepest is at 280°.
    let (deepest, _) = coloured().max_by_key(|(_, value)| **value).expect("a colour");
    let [x, y] = [0, 1].map(|k| deepest.iter().map(|end| vertices[*end][k]).sum::<f64>());
    let degrees = y.atan2(x).to_degrees().rem_euclid(360.0);
    assert!((degrees - 280.0).abs() < 12.0, "{degrees}");
}

/// Returns the colours of the bodies of the 3-D view.
fn colours_of_bodies(scene: &Value) -> Vec<&Value> {
    scene["bodies"].as_array().expect("a list").iter().map(|body| &body["colour"]).collect()
}

#[test]
fn a_job_has_tools_fixtures_and_stock() {
    let (bench, job) = bracket();
    bench.write("bracket.toml", job);
    let page = Page::write(&bench, "bracket.toml");
    assert_same_findings(&page, &bench.touchoff("verify bracket.toml --json"));
    assert_self_contained(&page);
    let scene = page.data("scene");
    let names = |list: &str, key: &str| -> Vec<String> {
        let list = scene[list].as_array().expect("a list").iter();
        list.map(|row| row[key].as_str().expect("a text").to_owned()).collect()
    };
    assert_eq!(names("bodies", "name"), ["the part", "the vise", "what remains of the stock"]);
    let colours = colours_of_bodies(&scene);
    assert!(colours[1] != colours[0] && colours[2] == colours[0], "{colours:?}");
    let tools = scene["path"]["tools"].as_array().expect("a list").iter();
    let tools: Vec<_> = tools.map(|tool| tool["name"].as_str().expect("a text")).collect();
    assert_eq!(tools, ["T1 Face40", "T3 Mill10", "T2 Ball6"]);
    let layers = names("layers", "quantity");
    assert!(layers.iter().any(|layer| layer.contains("in the vise")), "{layers:?}");
    assert!(layers.iter().any(|layer| layer.starts_with("material left")), "{layers:?}");
    for tool in ["T1 Face40", "T2 Ball6", "T3 Mill10"] {
        assert!(page.text.contains(&format!("<h3>{tool}")), "{tool}");
    }
    for line in ["Machine: A-C trunnion", "Control: mill.toml", "3 motions not checked"] {
        assert!(page.text.contains(line), "{line}");
    }
    // Job, part, program, control, three tools and the vise.
    assert_eq!(page.between("<td><code>", "</code>").len(), 8);
}

/// The path of a tip: down in rapid traverse, around a circle at feed rate, and up. The circle is drawn within a thousandth of
/// the part's extent of 6 mm.
#[test]
fn the_path_is_drawn_in_the_part() {
    let bench = Bench::new();
    let program = "G21 G90 G54 G17\nT1 M6\nS900 M3\nG0 X8. Y0.\nG43 H1 Z5.\nZ1.\nG3 X8. Y0. I-8. J0. F100.\nG0 Z5.\nM30\n";
    bench.write("circle.nc", program);
    let options = "--unit mm --tool D2Ball --program circle.nc --control linuxcnc --anyway";
    let page = Page::write(&bench, &format!("block.stl {options}"));
    assert_self_contained(&page);
    let path = &page.data("scene")["path"];
    let bytes = |key: &str| STANDARD.decode(path[key].as_str().expect("a text")).expect("base64");
    let (low, step) = (numbers(&path["low"]), numbers(&path["step"]));
    let vertices: Vec<[f64; 3]> = bytes("vertices")
        .chunks(6)
        .map(|six| {
            [0, 1, 2].map(|k| {
                let steps = u16::from_le_bytes([six[2 * k], six[2 * k + 1]]);
                low[k] + f64::from(steps) * step[k]
            })
        })
        .collect();
    let ways = bytes("ways");
    assert_eq!(ways.len(), vertices.len());
    let (feed, rapid): (Vec<_>, Vec<_>) =
        (1..ways.len()).filter(|k| ways[*k] > 0).partition(|k| ways[*k] == 1);
    assert!(ways[0] == 0 && rapid.iter().all(|k| ways[*k] == 2));
    let is_near = |one: f64, other: f64| (one - other).abs() < 1e-3;
    for k in &rapid {
        let [x, y, z] = vertices[*k];
        assert!(is_near(x, 8.0) && is_near(y, 0.0) && (is_near(z, 1.0) || is_near(z, 5.0)));
    }
    // The middles of chords are nearest to the axis.
    let mut turned = 0.0;
    for k in feed {
        let [from, to] = [vertices[k - 1], vertices[k]];
        let radius = (0.5 * (from[0] + to[0])).hypot(0.5 * (from[1] + to[1]));
        assert!((8.0 - 0.0071..8.001).contains(&radius), "{radius}");
        let cross = from[0] * to[1] - from[1] * to[0];
        turned += cross.atan2(from[0] * to[0] + from[1] * to[1]);
    }
    assert!(is_near(turned, std::f64::consts::TAU), "{turned}");
    assert!(page.text.contains("curves within 0.0060 mm."), "the caption");
}

/// Returns the lines of the program in a row: the mark, the number and the text of each.
fn excerpt(row: &str) -> Vec<(char, usize, String)> {
    let (_, lines) = row.split_once("<pre>").expect("an excerpt");
    let (lines, _) = lines.split_once("</pre>").expect("its end");
    let lines = lines.split("<span").skip(1).map(|line| {
        let (_, line) = line.split_once('>').expect("a line");
        let line = line.split_once("\n</span>").expect("its end").0;
        let line = line.replace("&gt;", ">");
        let mark = line.chars().next().expect("a mark");
        let (number, text) = line[1..].trim_start().split_once("  ").expect("a number and a text");
        (mark, number.parse().expect("a number"), text.to_owned())
    });
    lines.collect()
}

/// The program around each finding: cutter locations of APT, then a table.
#[test]
fn findings_show_the_program_around_them() {
    let bench = Bench::new();
    let Gouging { part, program } = bench.gouging();
    let options = format!("--unit mm --tool D2Ball --program {program} --tolerance 0.01");
    let page = Page::write(&bench, &format!("{part} {options}"));
    let text = std::fs::read_to_string(&program).expect("a program");
    let text: Vec<&str> = text.lines().collect();
    let findings = page.data("findings");
    let findings = findings.as_array().expect("a list");
    assert!(!findings.is_empty());
    for (finding, row) in findings.iter().zip(page.rows()) {
        let number = |key: &str| finding[key].as_u64().expect("a number") as usize;
        let shown = excerpt(row);
        assert_eq!(shown.len(), 7);
        for (mark, line, shown) in &shown {
            assert_eq!(shown, text[line - 1]);
            let within = (number("first_line")..=number("last_line")).contains(line);
            let expected = match *line == number("line") {
                true => '>',
                false if within => '|',
                false => ' ',
            };
            assert_eq!(*mark, expected, "line {line} of {finding}");
        }
        assert_eq!(shown[3].1, number("line"));
    }

    // At the ends of a table, of which the last line is long and has markup.
    let comment = format!("# <b>{}", "x".repeat(200));
    bench.write("path.csv", format!("# a comment\n0,0,1,0,0,1\n0,0,-0.5,0,0,1 {comment}"));
    let options = "--unit mm --tool D2Ball --program path.csv --tolerance 0.1";
    let page = Page::write(&bench, &format!("block.stl {options}"));
    let rows = page.rows();
    let shown = excerpt(rows[0]);
    let numbers: Vec<_> = shown.iter().map(|(mark, line, _)| (*mark, *line)).collect();
    assert_eq!(numbers, [(' ', 1), (' ', 2), ('>', 3)]);
    assert!(shown[2].2.starts_with("0,0,-0.5,0,0,1 # &lt;b>xxx"), "{}", shown[2].2);
    assert!(shown[2].2.ends_with("xx…") && shown[2].2.len() < 140, "{}", shown[2].2);
    assert_self_contained(&page);

    // A program in Windows-1252.
    std::fs::write(bench.place("path.csv"), b"# Fr\xe4sen\n0,0,1,0,0,1\n0,0,-0.5,0,0,1\n")
        .expect("written");
    let page = Page::write(&bench, &format!("block.stl {options}"));
    assert_eq!(excerpt(page.rows()[0])[0].2, "# Fräsen");
}

/// Lines of a long program are in the file around findings alone.
#[test]
fn a_long_program_makes_a_short_report() {
    let bench = Bench::new();
    let filling = "(FILLING)\n".repeat(500_000);
    let program = format!(
        "G21 G90 G54\nT1 M6\nS900 M3\nG0 X-9. Y0.\nG43 H1 Z5.\n{filling}G1 Z-0.5 F100.\nX9.\n{filling}M30\n"
    );
    bench.write("long.nc", program);
    let options = "--unit mm --tool D2Ball --program long.nc --control linuxcnc --anyway";
    let page = Page::write(&bench, &format!("block.stl {options}"));
    let rows = page.rows();
    assert_eq!(excerpt(rows[0])[3], ('>', 500_007, "X9.".to_owned()));
    let shown = page.text.matches("(FILLING)").count();
    assert!(shown <= 6 * rows.len() && shown > 0, "{shown}");
}

/// The colours of findings are computed from a bounded number of contacts: all points of the part lie in a large tool at each finding.
#[test]
fn many_findings_of_a_large_tool_colour_a_bounded_number_of_places() {
    let bench = Bench::new();
    let profile =
        "start (0, 0); arc to (90, 90) center (0, 90) as ball cutting; line to (0, 90) as top;";
    bench.write(
        "large.tool",
        format!("tool Large {{ units mm; profile {{ {profile} }} niceness cutting: 1; }}"),
    );
    let rows: String =
        (0..60).map(|row| format!("0,0,{},0,0,1\n", -10.0 - 0.01 * f64::from(row))).collect();
    bench.write("rows.csv", rows);
    let page = Page::write(&bench, "block.stl --unit mm --tool large.tool --program rows.csv");
    let scene = page.data("scene");
    let quantity = scene["layers"][0]["quantity"].as_str().expect("a name");
    assert!(quantity.contains(" of 60; of the others, at the deepest point)"), "{quantity}");
}

#[test]
fn files_have_their_digests() {
    let bench = Bench::new();
    let options = "--unit mm --tool D2Ball --program path.csv --tolerance 0.6";
    let page = Page::write(&bench, &format!("block.stl {options}"));
    assert_eq!(page.output.status.code(), Some(0), "{}", stderr(&page.output));
    assert!(page.text.contains("no findings: every motion is proved"), "the verdict");
    // By `sha256sum`.
    let digest = "0a6162095ff2298624b5e6ed9dc25ff4f153c49ea8898a5bee921fdc0334a57d";
    assert!(page.text.contains(digest), "the program's digest");
    assert_eq!(page.data("findings"), Value::Array(Vec::new()));
    assert_self_contained(&page);
}

#[test]
fn text_of_files_is_not_markup() {
    let bench = Bench::new();
    let tool = "tool Odd \"<b>6 mm</b> & 'round' <!--<script>\" { units mm; profile { start (0, 0); arc to (3, 3) center (0, 3) \
                as ball cutting; line to (3, 20), (0, 20) as shank; } niceness cutting: 1; }";
    let tool = bench.write("<i>&'\"odd\".tool", tool);
    let part = bench.write(
        "a<b>&amp;\"c'.stl",
        std::fs::read(bench.folder.path().join("block.stl")).expect("a part"),
    );
    let program = "UNITS/MM\nGOTO/-9,0,3,0,0,1\nGOTO/-9,0,-0.5,0,0,1\nGOTO/9,0,-0.5,0,0,1\nFINI\n";
    let program = bench.write("<script>alert(1)<!--\u{202e}.apt", program);
    let page = Page::write(&bench, &format!("{part} --unit mm --tool {tool} --program {program}"));
    assert_eq!(page.output.status.code(), Some(1), "{}", stderr(&page.output));
    assert_self_contained(&page);
    let findings = page.data("findings");
    assert_eq!(findings[0]["file"], program.as_str());
    let title = page.data("scene")["title"].as_str().expect("a text").to_owned();
    assert!(title.starts_with("a<b>&amp;\"c'.stl: <script>alert(1)<!--"), "{title}");
    for word in ["<script>alert", "<b>6", "a<b>", "<i>", "<!--", "\u{202e}", "&'\"odd"] {
        assert!(!page.text.contains(word), "{word}");
    }
    for word in [
        "a&lt;b&gt;&amp;amp;&quot;c'.stl",
        "&lt;script&gt;alert(1)&lt;!--\\u202e.apt",
        "&lt;b&gt;6 mm&lt;/b&gt; &amp; 'round' &lt;!--&lt;script&gt;",
    ] {
        assert!(page.text.contains(word), "{word}");
    }
}

#[test]
fn a_map_adds_its_quantities() {
    let bench = Bench::new();
    let swept =
        "sweep --part block.stl --unit mm --tool BallEr16 --directions 20 -o block.postures";
    let swept = bench.touchoff(swept);
    assert!(swept.status.success(), "{}", stderr(&swept));
    let options = "--unit mm --tool D2Ball --tolerance 0.6 --program path.csv --map block.postures";
    let page = Page::write(&bench, &format!("block.stl {options}"));
    let scene = page.data("scene");
    let layers = scene["layers"].as_array().expect("a list").iter();
    let layers: Vec<&str> = layers.filter_map(|layer| layer["quantity"].as_str()).collect();
    let starts = ["depth of the deepest", "niceness", "solid angle", "least stick-out"];
    assert_eq!(layers.len(), starts.len(), "{layers:?}");
    for (layer, start) in layers.iter().zip(starts) {
        assert!(layer.starts_with(start), "{layer}");
    }
    // A picture of each, in the reading order of the file.
    assert!(page.between("data:image/png;base64,", "\"").len() >= layers.len());

    // A map of another part is refused.
    let other = shapes::sphere(4.0, 2, Unit::Millimetre).expect("a sphere");
    bench.part("other.stl", &other);
    let refused = bench.touchoff(&format!("report other.stl {options} -o no.html"));
    assert_eq!(refused.status.code(), Some(2), "{}", stderr(&refused));
    assert!(!bench.folder.path().join("no.html").exists());
}

#[test]
fn inputs_are_never_overwritten() {
    let bench = Bench::new();
    let part = std::fs::read(bench.place("block.stl")).expect("a part");
    bench.write("part.html", part);
    bench.write("program.html", "0,0,1,0,0,1\n0,0,-0.5,0,0,1\n");
    let inputs = "part.html --unit mm --tool D2Ball --program program.html";
    for output in ["part.html", "program.html"] {
        let before = std::fs::read(bench.place(output)).expect("a file");
        let refused = bench.touchoff(&format!("report {inputs} -o {output}"));
        assert_eq!(refused.status.code(), Some(2), "{}", stderr(&refused));
        assert!(stderr(&refused).contains("is also an input"), "{}", stderr(&refused));
        assert_eq!(std::fs::read(bench.place(output)).expect("a file"), before);
    }
    let refused = |arguments: &str, word: &str| {
        let output = bench.touchoff(&format!("report {arguments}"));
        assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
        assert!(stderr(&output).contains(word), "{word}: {}", stderr(&output));
    };
    bench.write("job.toml", "part = \"part.html\"\n");
    refused("part.html --unit mm -o r.html", "`--program`");
    refused(&format!("{inputs} -o r.pdf"), "`-o r.html`");
    refused("job.toml --tool D2Ball -o r.html", "leave out these options");
}

/// The verdict is that of `verify`, also where there is none.
#[test]
fn an_implausible_program_is_not_verified() {
    let bench = Bench::new();
    bench.write("far.csv", "900,0,1,0,0,1\n900,0,-0.5,0,0,1\n");
    let page = Page::write(&bench, "block.stl --unit mm --tool D2Ball --program far.csv");
    assert_eq!(page.output.status.code(), Some(2), "{}", stderr(&page.output));
    assert!(page.text.contains("<strong>no verdict: "), "the verdict");
    assert!(page.text.contains("never comes within the tool's diameter"), "the reason");
}

/// The impeller, where the folder of shared parts is there; else a fine sphere.
#[test]
fn a_large_part_makes_a_bounded_file() {
    let bench = Bench::new();
    let (part, program) = match shared() {
        Some(folder) => {
            let file = |name: &str| folder.join(name).display().to_string();
            (file("parts/impeller.stl"), file("paths/impeller_flank.apt"))
        }
        None => {
            let sphere: Mesh = shapes::sphere(20.0, 6, Unit::Millimetre).expect("a sphere");
            bench.part("sphere.stl", &sphere);
            let program = bench.write("path.csv", "0,0,22,0,0,1\n0,0,19.8,0,0,1\n9,0,19.8,0,0,1\n");
            (bench.place("sphere.stl"), program)
        }
    };
    let options = format!("--unit mm --tool D2Ball --program {program} --tolerance 0.01");
    let page = Page::write(&bench, &format!("{part} {options}"));
    assert_eq!(page.output.status.code(), Some(1), "{}", stderr(&page.output));
    assert!(page.rows().len() == page.data("findings").as_array().expect("a list").len());
    assert_self_contained(&page);
}
