//! Libraries that leave something out, or write it in a way that cannot be read. Nothing is invented: the tool stays
//! the same because the value has no influence, or it is left out, or a note says what was taken.

use crate::libraries;
use serde_json::{Value, json};
use touchoff_import::Library;
use touchoff_tests::fusion;

/// Keys whose absence has a meaning in the format itself: a tool without a neck, without a shaft, without a holder.
const OPTIONAL: [&str; 5] =
    ["shoulder-length", "shoulder-diameter", "shaft", "holder", "post-process"];

/// The result of reading one tool.
#[derive(Debug, PartialEq)]
enum Outcome {
    Refused,
    LeftOut,
    /// The geometry of the tool's files, and its notes.
    Tool(Vec<String>, Vec<String>),
}

fn outcome(name: &str, text: &str) -> Outcome {
    let Ok(library) = Library::parse(name.as_ref(), text.as_bytes()) else {
        return Outcome::Refused;
    };
    let Some(tool) = library.tools().first() else { return Outcome::LeftOut };
    // Names, titles and comments are no geometry.
    let code = |text: &str| -> String {
        let lines =
            text.lines().filter(|line| !line.starts_with("//") && !line.starts_with("tool "));
        lines.flat_map(|line| line.split('"').step_by(2)).collect()
    };
    Outcome::Tool(
        tool.files.iter().map(|file| code(&file.text)).collect(),
        tool.entry.notes.iter().map(ToString::to_string).collect(),
    )
}

/// Asserts that a changed tool is the same, or left out, or has other notes.
fn assert_nothing_invented(name: &str, whole: &str, changed: &str, what: &str) {
    let (before, after) = (outcome(name, whole), outcome(name, changed));
    let Outcome::Tool(files, notes) = &before else { panic!("{name}: {before:?}\n{whole}") };
    if let Outcome::Tool(changed_files, changed_notes) = &after {
        assert!(
            files == changed_files || notes != changed_notes,
            "{name}: without {what} the tool differs, and no note says so: {changed_files:?}"
        );
    }
}

/// Returns the pointer to every value of an object, at any depth.
fn pointers(value: &Value, at: &str, found: &mut Vec<String>) {
    let children: Vec<(String, &Value)> = match value {
        Value::Object(object) => object.iter().map(|(key, value)| (key.clone(), value)).collect(),
        Value::Array(list) => list.iter().enumerate().map(|(k, v)| (k.to_string(), v)).collect(),
        _ => return,
    };
    for (key, child) in children {
        let pointer = format!("{at}/{key}");
        pointers(child, &pointer, found);
        found.push(pointer);
    }
}

/// Returns a value without what a pointer names.
fn without(value: &Value, pointer: &str) -> Value {
    let mut value = value.clone();
    let (parent, key) = pointer.rsplit_once('/').expect("a pointer");
    match value.pointer_mut(parent).expect("the parent") {
        Value::Object(object) => drop(object.remove(key)),
        Value::Array(list) => drop(list.remove(key.parse().expect("an index"))),
        _ => unreachable!("only objects and lists have children"),
    }
    value
}

/// Omits each value of a tool, and replaces it by values that cannot be read.
fn assert_each_value_counts(name: &str, tool: &Value, wrap: impl Fn(&Value) -> Value) {
    let whole = wrap(tool).to_string();
    let mut found = Vec::new();
    pointers(tool, "", &mut found);
    for pointer in &found {
        let key = pointer.rsplit('/').next().unwrap_or("");
        // A profile without one of its corners is another profile, and a stack without a section another stack.
        let is_item = key.parse::<usize>().is_ok() && !pointer.ends_with("end/0");
        if !OPTIONAL.contains(&key) && !is_item {
            let changed = wrap(&without(tool, pointer)).to_string();
            assert_nothing_invented(name, &whole, &changed, pointer);
        }
        for wrong in [Value::Null, json!("?"), json!([]), json!({})] {
            // A shaft without segments is none.
            let is_none = pointer == "/shaft/segments" && wrong == json!([]);
            if is_none || (wrong.is_null() && OPTIONAL.contains(&key)) {
                continue;
            }
            let mut changed = tool.clone();
            *changed.pointer_mut(pointer).expect("the value") = wrong;
            assert_nothing_invented(name, &whole, &wrap(&changed).to_string(), pointer);
        }
    }
    assert!(found.len() > 3, "{name}: nothing to omit in {tool}");
}

#[test]
fn fusion_tools_invent_nothing() {
    for tool in fusion::tools() {
        assert_each_value_counts("l.json", &tool, |tool| json!({ "data": [tool] }));
    }
}

#[test]
fn freecad_bits_invent_nothing() {
    for bit in libraries::bits() {
        assert_each_value_counts("b.fctb", &bit, Value::clone);
    }
}

#[test]
fn tools_of_simulators_invent_nothing() {
    for tool in libraries::kiri().as_array().expect("a list") {
        assert_each_value_counts("l.json", tool, |tool| json!([tool]));
    }
    for (number, tool) in libraries::camotics().as_object().expect("an object") {
        assert_each_value_counts("l.json", tool, |tool| json!({ number: tool }));
    }
}

/// Attributes of an HSM tool, one by one.
#[test]
fn hsm_tools_invent_nothing() {
    let files = libraries::files();
    let library = &files.iter().find(|seed| seed.name.ends_with("hsmlib")).expect("a library").text;
    let (head, tools) = library.split_once("<tool guid=\"a\"").expect("a tool");
    let (first, second) = tools.split_once("<tool guid=\"b\"").expect("a second tool");
    let mut tried = 0;
    for (guid, tool) in [("a", first.trim_end()), ("b", second.trim_end())] {
        let tool = tool.trim_end_matches("</tool-library>");
        let text = |tool: &str| format!("{head}<tool guid=\"{guid}\"{tool}</tool-library>");
        for (at, _) in tool.match_indices("=\"") {
            let start = tool[..at].rfind(' ').map_or(0, |space| space + 1);
            let key = &tool[start..at];
            let end = at + 2 + tool[at + 2..].find('"').expect("a closing quote") + 1;
            let value = &tool[at + 2..end - 1];
            let omitted = text(&format!("{}{}", &tool[..start], &tool[end..]));
            let wrong = text(&format!("{}?{}", &tool[..at + 2], &tool[end - 1..]));
            if !OPTIONAL.contains(&key) {
                assert_nothing_invented("l.hsmlib", &text(tool), &omitted, key);
            }
            assert_nothing_invented("l.hsmlib", &text(tool), &wrong, &format!("{key}={value}"));
            tried += 1;
        }
    }
    assert!(tried > 25, "{tried} attributes");
}

/// A field of a cutter that is no number must not be skipped: the ones after it would move.
#[test]
fn cutters_of_programs_invent_nothing() {
    for cutter in ["CUTTER/10,1.5,3.5,1.5,0,0,40", "TLDATA/MILL,8,0.5,50,0,0"] {
        let text = |cutter: &str| format!("UNITS/MM\n{cutter}\nLOADTL/2\nFINI\n");
        let (word, fields) = cutter.split_once('/').expect("a statement");
        let fields: Vec<&str> = fields.split(',').collect();
        for k in 0..fields.len() {
            let mut changed = fields.clone();
            changed[k] = "X";
            let changed = text(&format!("{word}/{}", changed.join(",")));
            assert_eq!(outcome("p.apt", &changed), Outcome::LeftOut, "{changed}");
        }
    }
}
