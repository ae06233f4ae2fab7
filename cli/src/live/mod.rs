//! `touchoff live`: a page on loopback in which one drags a tool against a part.

mod server;

use crate::arguments::{Live, ParamArguments};
use crate::failure::Failure;
use crate::loaded_tool::{SourceFiles, load_file, read_source, source_files};
use crate::output::{Output, file_name};
use crate::part;
use serde::Serialize;
use server::{Content, Page};
use std::collections::BTreeMap;
use std::ffi::{OsStr, OsString};
use std::io::Write;
use std::net::{Ipv4Addr, TcpListener};
use std::path::Path;
use touchoff::{FileKind, Unit, read_regular_file, read_text_file};
use touchoff_dsl::compile;
use touchoff_verify::Program;
use touchoff_verify::gcode::ControlSetup;
use touchoff_verify::job::DEFAULT_MACHINE;

/// The part and the tools that the page begins with.
#[derive(Serialize)]
struct Begin {
    part: Option<BeginPart>,
    tools: Vec<BeginTool>,
    program: Option<BeginProgram>,
}

#[derive(Serialize)]
struct BeginPart {
    name: String,
    unit: &'static str,
}

/// A library tool by its file, or the text of a tool and of the files that it mounts.
#[derive(Serialize)]
struct BeginTool {
    /// Its number in the program, if it is given.
    number: Option<u32>,
    name: String,
    text: Option<String>,
    files: BTreeMap<String, String>,
}

#[derive(Serialize)]
struct BeginProgram {
    name: String,
    machine: Option<BeginMachine>,
}

/// A machine that comes with the library by its name, or the text of another one's file.
#[derive(Serialize)]
struct BeginMachine {
    name: String,
    text: Option<String>,
}

/// The page's address, for programs.
#[derive(Serialize)]
struct AddressRow<'a> {
    address: &'a str,
}

/// Serves the page until the program is ended.
pub(crate) fn live(arguments: &Live, json: bool) -> Result<(), Failure> {
    let part = match (&arguments.part, arguments.unit) {
        (Some(file), Some(unit)) => Some(read_part(file, unit)?),
        _ => None,
    };
    let tools = begin_tools(&arguments.tool)?;
    let machine = arguments.machine.as_deref().map(Path::new);
    let program =
        arguments.program.as_deref().map(|file| read_program(file, machine)).transpose()?;
    let ((part, part_bytes), (program, program_bytes)) = (part.unzip(), program.unzip());
    let begin = serde_json::to_vec(&Begin { part, tools, program })?;
    let mut page = Page::embedded();
    page.add("/session.json", Content::json(begin));
    for (path, bytes) in [("/part", part_bytes), ("/program", program_bytes)] {
        if let Some(bytes) = bytes {
            page.add(path, Content::bytes(bytes));
        }
    }
    let port = arguments.port;
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port))
        .map_err(|source| Failure::Port { port, source })?;
    let port = listener.local_addr()?.port();
    let address = format!("http://127.0.0.1:{port}/");
    let mut out = Output::lines();
    if json {
        out.json(&AddressRow { address: &address })?;
    } else {
        writeln!(out, "{address}")?;
        message!("serving the page until Ctrl-C");
    }
    out.flush()?;
    // The lock of standard output, as the server never ends.
    drop(out);
    if !arguments.no_open
        && let Err(error) = open::that_detached(&address)
    {
        message!("cannot open a browser: {error}; open the address in one");
    }
    server::serve(&listener, port, page);
    Ok(())
}

/// Reads a part's file, after a check that it is a mesh.
fn read_part(file: &Path, unit: Unit) -> Result<(BeginPart, Vec<u8>), Failure> {
    part::mesh(file, unit, "`touchoff live`")?;
    let bytes = read_regular_file(file, FileKind::Geometry)?;
    Ok((BeginPart { name: file_name(file), unit: unit.symbol() }, bytes))
}

/// Reads a program's file, after a check that it can be followed.
fn read_program(file: &Path, machine: Option<&Path>) -> Result<(BeginProgram, Vec<u8>), Failure> {
    let program = Program::read(file, machine, &ControlSetup::default())?;
    program.check_complete()?;
    let machine = match program {
        Program::Locations(_) => None,
        Program::Machine(_) => {
            let machine = machine.unwrap_or(Path::new(DEFAULT_MACHINE));
            // The page has the machines of the library, by their names.
            let is_file = machine.extension().is_some_and(|extension| extension == "toml");
            let text = is_file.then(|| read_text_file(machine, FileKind::Settings));
            Some(BeginMachine { name: file_name(machine), text: text.transpose()? })
        }
    };
    Ok((
        BeginProgram { name: file_name(file), machine },
        read_regular_file(file, FileKind::Program)?,
    ))
}

/// Returns the tools as the page takes them: one for all motions, or each with its number in the program.
fn begin_tools(given: &[OsString]) -> Result<Vec<BeginTool>, Failure> {
    let mut tools: Vec<BeginTool> = Vec::new();
    for text in given {
        let numbered = text.to_str().and_then(|text| text.split_once('='));
        let numbered = numbered.and_then(|(number, name)| Some((number.parse().ok()?, name)));
        let (number, name) = match numbered {
            Some((number, name)) => (Some(number), OsStr::new(name)),
            None => (None, &**text),
        };
        // A tool without a number makes all motions.
        if number.is_none() && given.len() > 1 || tools.iter().any(|tool| tool.number == number) {
            let reason =
                "of several tools each has a number of its own: `--tool 1=D2Ball,2=drill.tool`";
            return Err(Failure::Usage(reason));
        }
        let tool = begin_tool(number, name)?;
        // The page knows tools by the names of their files.
        if tools.iter().any(|known| known.name == tool.name && known.text != tool.text) {
            return Err(Failure::Usage("two tools have files of one name: rename one of them"));
        }
        tools.push(tool);
    }
    Ok(tools)
}

/// Returns a tool as the page takes it.
fn begin_tool(number: Option<u32>, name: &OsStr) -> Result<BeginTool, Failure> {
    let path = Path::new(name);
    if path.extension().is_none_or(|extension| extension != "tool") {
        let SourceFiles { file, .. } = source_files(&name.to_string_lossy())?;
        return Ok(BeginTool { number, name: file.to_owned(), text: None, files: BTreeMap::new() });
    }
    let arguments = ParamArguments::default();
    // Fails with the diagnostics if the file has errors.
    load_file(path, &arguments)?;
    let compiled = compile(&read_source(path, &arguments)?);
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut files = BTreeMap::new();
    for source in &compiled.sources.all()[1..] {
        if let Some(mounted) = source.path() {
            let relative = mounted.strip_prefix(folder).unwrap_or(mounted);
            files.insert(relative.display().to_string(), source.text.clone());
        }
    }
    let name = file_name(path);
    Ok(BeginTool { number, name, text: Some(compiled.sources.main().text.clone()), files })
}
