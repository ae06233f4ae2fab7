//! Jobs that name other files: further parts, earlier set-ups, machines with bodies.

use crate::scene::{CLEAN, Checked, FINDINGS, NONE, rules};
use nalgebra::Point3;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use tempfile::TempDir;
use touchoff::mesh::shapes;
use touchoff::tool::{Interpreted, ToolError};
use touchoff::{Mesh, Tool, Unit};
use touchoff_verify::gcode::ControlRules;
use touchoff_verify::job::{FindingDetail, FindingRule, JobInputs};
use touchoff_verify::machine::Machine;
use touchoff_verify::{FindingKind, JobError, JobFile, JobReport, Verdict};

/// A tool of a job.
struct Loaded(Interpreted);

impl AsRef<dyn Tool + 'static> for Loaded {
    fn as_ref(&self) -> &(dyn Tool + 'static) {
        &self.0
    }
}

/// A reason for which a job and its files are not read.
#[derive(Debug, thiserror::Error)]
enum ReadError {
    #[error(transparent)]
    Job(#[from] JobError),
    #[error(transparent)]
    Tool(#[from] ToolError),
}

/// A folder with the files of a job.
struct Folder {
    folder: TempDir,
    /// The folder within which the job may read, if not this one.
    root: Option<PathBuf>,
}

impl Folder {
    fn new() -> Folder {
        Folder { folder: tempfile::tempdir().expect("a folder"), root: None }
    }

    fn place(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        std::fs::write(self.place(name), content).expect("a writable folder");
    }

    fn cuboid(&self, name: &str, low: [f64; 3], high: [f64; 3]) {
        let mesh = shapes::cuboid(Point3::from(low), Point3::from(high), Unit::Millimetre);
        self.mesh(name, &mesh.expect("a cuboid"));
    }

    fn mesh(&self, name: &str, mesh: &Mesh) {
        let mut bytes = Vec::new();
        mesh.write_stl(&mut bytes).expect("memory");
        self.write(name, bytes);
    }

    /// Checks a job that stands in this folder, and hands on its report.
    fn with_report<T>(
        &self,
        job: &str,
        found: impl FnOnce(&JobReport<'_>) -> T,
    ) -> Result<T, ReadError> {
        self.write("job.toml", job);
        let file = JobFile::read(&self.place("job.toml"), self.root.as_deref())?;
        let inputs = JobInputs::read::<ReadError>(file, |named| {
            Ok(Loaded(Interpreted::load(&named.name)?))
        })?;
        for (named, tool) in &inputs.tools {
            let info = tool.0.info();
            inputs
                .program
                .check_tool(named.motions, info, inputs.file.unit)
                .map_err(JobError::from)?;
        }
        let job = inputs.job();
        let report = job.check(&|_| ())?;
        Ok(found(&report))
    }

    fn check(&self, job: &str) -> Checked {
        match self.with_report(job, Checked::of) {
            Ok(checked) => checked,
            Err(ReadError::Job(error)) => Checked::refused(&error),
            Err(error) => panic!("{error}\n{job}"),
        }
    }

    #[track_caller]
    fn gives(&self, job: &str, verdict: Verdict, patterns: &[&str]) {
        self.check(job).assert(verdict, patterns, job);
    }

    /// Asserts the code of a job that is refused after a change, and a word of its sentence.
    #[track_caller]
    fn refuses(&self, job: &str, [from, to]: [&str; 2], pattern: &str) {
        assert!(job.contains(from), "{from}");
        self.gives(&job.replace(from, to), NONE, &[pattern]);
    }
}

const MILL: &str = "tool Mill10 \"10 mm end mill\" { units mm; profile { start (0, 0); line to (5, 0) as face cutting; \
                    line to (5, 22) as flute cutting; line to (5, 60), (0, 60) as shank; } niceness cutting: 1; }";

/// A job of few bytes can name one large mesh many times.
#[test]
fn bodies_share_the_mesh_of_a_file() {
    let folder = Folder::new();
    folder.cuboid("plate.stl", [-20.0, -20.0, -10.0], [20.0, 20.0, 0.0]);
    folder.write("mill10.tool", MILL);
    folder.write("one.nc", "G21 G90 G54\nT1 M6\nG0 X0. Y0.\nG43 H1 Z20.\nM30\n");
    let fixture = |name: &str| format!("[[fixture]]\nname = \"{name}\"\nmesh = \"plate.stl\"\n");
    let other = |offset: &str| format!("[[other_part]]\nwork_offset = \"{offset}\"\n");
    folder.write(
        "job.toml",
        format!(
            "part = \"plate.stl\"\nunit = \"mm\"\nprogram = \"one.nc\"\ncontrol = \"linuxcnc\"\n\
             [work_offsets]\nG54 = [0, 0, -300]\nG55 = [100, 0, -300]\nG56 = [100, 0, -300]\n\
             [tool.1]\ntool = \"mill10.tool\"\nlength = 60\n{}{}{}{}",
            other("G55"),
            other("G56"),
            fixture("one"),
            fixture("two")
        ),
    );
    let file = JobFile::read(&folder.place("job.toml"), None).expect("a job");
    let inputs =
        JobInputs::read::<ReadError>(file, |named| Ok(Loaded(Interpreted::load(&named.name)?)));
    let bodies = inputs.expect("inputs").bodies;
    let is_shared = |one: usize, other: usize| {
        Arc::ptr_eq(&bodies[one].mesh, &bodies[other].mesh)
            && Arc::ptr_eq(&bodies[one].bvh, &bodies[other].bvh)
    };
    assert!(bodies.len() == 5 && is_shared(0, 3) && is_shared(0, 4) && is_shared(1, 2));
    assert!(!is_shared(0, 1));
}

/// Two parts on one table: each is checked where it stands, with the motions of the whole program.
#[test]
fn a_job_has_a_part_per_work_offset() {
    let folder = Folder::new();
    folder.cuboid("plate.stl", [-20.0, -20.0, -10.0], [20.0, 20.0, 0.0]);
    folder.cuboid("bar.stl", [-20.0, -5.0, -10.0], [20.0, 5.0, 4.0]);
    folder.write("mill10.tool", MILL);
    let program = |height: f64, end: &str| {
        let text = format!(
            "G21 G90 G54 G94 F300.\nT1 M6\nS900 M3\nG0 X-30. Y0.\nG43 H1 Z20.\nZ0.\nG1 X30.\nG0 Z20.\n\
             G55 X-30. Y0.\nZ{height}\nG1 X30.\nG0 Z20.\nG54 X0.\n{end}M30\n"
        );
        folder.write("two.nc", text);
    };
    let text = "part = \"plate.stl\"\nunit = \"mm\"\nprogram = \"two.nc\"\ncontrol = \"linuxcnc\"\n\
                [work_offsets]\nG54 = [0, 0, -300]\nG55 = [100, 0, -300]\n[tool.1]\ntool = \"mill10.tool\"\nlength = 60\n\
                [[other_part]]\nwork_offset = \"G55\"\nmesh = \"bar.stl\"\n";
    program(4.0, "");
    folder.gives(text, CLEAN, &[]);
    let summaries = folder.with_report(text, |report| report.summaries()).expect("a report");
    let is_other = |summary: &String| summary.starts_with("T1 at the part at G55: no findings");
    assert!(summaries.iter().any(is_other), "{summaries:?}");
    // Without it nothing is near under G55, and a copy of the plate is lower.
    let (alone, _) = text.split_once("[[other_part]]").expect("its start");
    folder.gives(alone, NONE, &["V0603"]);
    program(3.5, "");
    folder.gives(text, FINDINGS, &["V0101 11 T1 face is 0.5000 mm deep in the part at G55 at ("]);
    folder.gives(&text.replace("mesh = \"bar.stl\"\n", ""), CLEAN, &[]);
    // A motion under G54 that runs into the other part.
    program(4.0, "Z2.\nX100.\nZ20.\n");
    let named = format!("{text}name = \"the bar\"\n");
    folder.gives(&named, FINDINGS, &["V01 15 the bar", "V01 15 in rapid traverse"]);

    for (change, pattern) in [
        (["work_offset = \"G55\"", "work_offset = \"G54\""], "J0129"),
        (["work_offset = \"G55\"", "work_offset = \"G56\""], "J0130"),
        (["G55 = [100, 0, -300]", "G55 = [100, 0, -300, 5]"], "J0131"),
        (["bar.stl", "none.stl"], "J0108 none.stl"),
        (["mesh = ", "meshes = "], "J0201 `meshes`"),
    ] {
        folder.refuses(text, change, pattern);
    }
}

/// A job of two set-ups: the first cuts one half of a block away, and the second has the other half, turned over about x.
#[test]
fn a_stock_is_what_an_earlier_set_up_leaves() {
    let folder = Folder::new();
    folder.cuboid("op10.stl", [-20.0, -20.0, -20.0], [20.0, -2.0, 0.0]);
    folder.cuboid("op20.stl", [-20.0, 2.0, -20.0], [20.0, 20.0, 0.0]);
    folder.write("mill10.tool", MILL);
    let start = "G21 G90 G54 G94 F300.\nT1 M6\nS900 M3\nG0 X-30. Y4.\nG43 H1 Z5.\n";
    let mut first = start.to_owned();
    for (level, row) in [-10.0, -20.5].iter().flat_map(|z| [4.0, 12.0, 20.0].map(|y| (z, y))) {
        first += &format!("G0 Z5.\nX-30. Y{row}\nZ{level}\nG1 X30.\n");
    }
    folder.write("op10.nc", first + "G0 Z5.\nM30\n");
    let second = |row: f64| {
        let text = format!("{start}G0 X-8. Y{row}\nZ-15.\nZ5.\nY-8.\nG1 Z-1.\nX8.\nG0 Z5.\nM30\n");
        folder.write("op20.nc", text);
    };
    let text = |setup: &str, stock: &str| {
        format!(
            "part = \"{setup}.stl\"\nunit = \"mm\"\nprogram = \"{setup}.nc\"\ncontrol = \"linuxcnc\"\n[work_offsets]\n\
             G54 = [0, 0, -300]\n[tool.1]\ntool = \"mill10.tool\"\nlength = 60\n[stock]\n{stock}\n"
        )
    };
    let block = "box = [[-20, -20, -20], [20, 20, 0]]\nspacing = 1";
    let turned = "from = \"op10.toml\"\norigin = [0, 0, -20]\nx = [1, 0, 0]\nz = [0, 0, -1]";
    let earlier = text("op10", block);
    folder.write("op10.toml", &earlier);
    folder.gives(&earlier, CLEAN, &[]);
    for (row, stock, verdict) in
        [(-8.0, turned, CLEAN), (12.0, turned, FINDINGS), (-8.0, block, FINDINGS)]
    {
        second(row);
        let checked = folder.check(&text("op20", stock));
        assert_eq!(checked.verdict, verdict, "{row}: {:#?}", checked.rows);
        assert_eq!(checked.has(FindingRule::Stock.code()), verdict == FINDINGS, "{row}");
    }
    second(-8.0);
    for (stock, pattern) in [
        (turned.replace("[0, 0, -1]", "[0, 0.6, -0.8]"), "J0409"),
        (format!("{turned}\nspacing = 1"), "J0124"),
        (format!("{turned}\nmesh = \"op10.stl\""), "J0127"),
        (turned.replace("op10", "op5"), "J0101 op5.toml"),
        (format!("{block}\norigin = [0, 0, -20]"), "J0125"),
        (block.replace("\nspacing = 1", ""), "J0126"),
        ("from = \"job.toml\"".to_owned(), "J0213"),
    ] {
        folder.gives(&text("op20", &stock), NONE, &[pattern]);
    }
    // An earlier set-up with another unit, without a stock, or with findings.
    let (without, _) = earlier.split_once("[stock]").expect("a stock");
    let other = text("op10", "box = [[-20, -20, -20], [20, 20, 8]]\nspacing = 1");
    for (earlier, pattern) in [
        (earlier.replace("\"mm\"", "\"inch\""), "J0214"),
        (without.to_owned(), "J0215"),
        (other, "V0605"),
    ] {
        folder.write("op10.toml", earlier);
        folder.gives(&text("op20", turned), NONE, &[pattern]);
    }
    // Findings are not left open, so nothing accepts them.
    folder.gives(&format!("anyway = true\n{}", text("op20", turned)), NONE, &["V0605"]);
}

/// Each set-up takes a part of the stack while those before it are read.
#[test]
fn a_chain_of_set_ups_is_short() {
    let folder = of_all_kinds();
    for setup in 0..=21 {
        let from = format!("from = \"{}.toml\"", setup + 1);
        let text = OF_ALL_KINDS.replace("mesh = \"stock.stl\"\nspacing = 2", &from);
        folder.write(&format!("job/{setup}.toml"), text);
    }
    let file = JobFile::read(&folder.place("job/0.toml"), None).expect("a job");
    let read =
        JobInputs::read::<ReadError>(file, |named| Ok(Loaded(Interpreted::load(&named.name)?)));
    let Err(ReadError::Job(error)) = read else { panic!("a chain without end is read") };
    assert_eq!(error.code(), "J0220", "{error}");
    assert!(error.to_string().contains("21.toml"), "{error}");
}

/// A job, of which every file is another kind of input.
const OF_ALL_KINDS: &str = "part = \"plate.stl\"\nunit = \"mm\"\nprogram = \"a.nc\"\ncontrol = \"c.toml\"\n\
    machine = \"m.toml\"\nsubprograms = [\"s.nc\"]\n[work_offsets]\nG54 = [0, 0, -300]\nG55 = [100, 0, -300]\n[tool.1]\n\
    tool = \"mill10.tool\"\nlength = 60\n[[other_part]]\nwork_offset = \"G55\"\nmesh = \"other.stl\"\n[[fixture]]\n\
    name = \"clamp\"\nmesh = \"clamp.stl\"\n[stock]\nmesh = \"stock.stl\"\nspacing = 2\noutput = \"rest.stl\"\nmap = \"map.csv\"\n";

/// The inputs of this job.
const INPUTS: [&str; 9] = [
    "plate.stl",
    "a.nc",
    "c.toml",
    "m.toml",
    "s.nc",
    "mill10.tool",
    "other.stl",
    "clamp.stl",
    "stock.stl",
];

/// Calls a function while a link stands instead of a file of the job.
#[cfg(unix)]
fn with_link(folder: &Folder, file: &str, target: &Path, check: impl FnOnce()) {
    let [place, kept] = [file, "kept"].map(|name| folder.place("job").join(name));
    std::fs::rename(&place, &kept).expect("renamed");
    std::os::unix::fs::symlink(target, &place).expect("a link");
    check();
    std::fs::rename(&kept, &place).expect("renamed");
}

/// Returns a folder `job` with such a job beside a folder `outside`, and a file of each kind there.
fn of_all_kinds() -> Folder {
    let folder = Folder::new();
    for name in ["job", "outside"] {
        std::fs::create_dir(folder.place(name)).expect("a folder");
        let within = |file: &str| format!("{name}/{file}");
        folder.cuboid(&within("plate.stl"), [-20.0, -20.0, -10.0], [20.0, 20.0, 0.0]);
        folder.cuboid(&within("other.stl"), [-20.0, -5.0, -10.0], [20.0, 5.0, 4.0]);
        folder.cuboid(&within("clamp.stl"), [-60.0, -5.0, -10.0], [-50.0, 5.0, 4.0]);
        folder.cuboid(&within("stock.stl"), [-20.0, -20.0, -10.0], [20.0, 20.0, 1.0]);
        folder.cuboid(&within("vice.stl"), [60.0, -5.0, -10.0], [70.0, 5.0, 4.0]);
        folder.write(&within("mill10.tool"), MILL);
        folder.write(
            &within("a.nc"),
            "G21 G90 G54 G94 F300.\nT1 M6\nS900 M3\nG0 X-30. Y0.\nG43 H1 Z20.\nM30\n",
        );
        folder.write(&within("s.nc"), "o<s> sub\no<s> endsub\nM2\n");
        folder
            .write(&within("c.toml"), ControlRules::named("linuxcnc").expect("it ships").to_toml());
        folder.write(&within("m.toml"), machine("vice.stl"));
    }
    folder
}

/// Returns the file of a machine on three axes with a mesh on its table.
fn machine(vice: &str) -> String {
    let text = Machine::file("3-axis").expect("it ships");
    format!(
        "{text}\n[[body]]\nname = \"the vice\"\nmoves_with = \"base\"\nmesh = \"{vice}\"\nagainst = [\"tool\"]\n"
    )
}

#[test]
fn a_job_reads_within_its_folder_or_the_root_and_writes_within_its_folder() {
    let mut folder = of_all_kinds();
    let inside = folder.place("job");
    let check = |folder: &Folder, text: &str| {
        folder.write("job/job.toml", text);
        let file = JobFile::read(&inside.join("job.toml"), folder.root.as_deref());
        file.map_err(ReadError::Job).and_then(|file| {
            JobInputs::read::<ReadError>(file, |named| {
                let source = Interpreted::source(&named.name)?
                    .with_root(named.root.as_ref().expect("a root"));
                Ok(Loaded(Interpreted::parse(&source)?))
            })
        })
    };
    let code = |folder: &Folder, text: &str| match check(folder, text) {
        Err(ReadError::Job(error)) => error.code(),
        Err(error) => panic!("{error}"),
        Ok(_) => "",
    };
    assert_eq!(code(&folder, OF_ALL_KINDS), "");
    let absolute = folder.place("outside").display().to_string();
    for input in INPUTS {
        for outside in ["../outside", &*absolute, "../job/../outside"] {
            let changed =
                OF_ALL_KINDS.replace(&format!("\"{input}"), &format!("\"{outside}/{input}"));
            assert_eq!(code(&folder, &changed), "J0132", "{input} in {outside}");
        }
    }
    // Files that a machine names are the job's too, and so are those of an earlier set-up.
    folder.write("job/m.toml", machine("../outside/vice.stl"));
    assert_eq!(code(&folder, OF_ALL_KINDS), "J0132");
    folder.write("job/m.toml", machine("vice.stl"));
    let earlier =
        OF_ALL_KINDS.replace("mesh = \"stock.stl\"\nspacing = 2\n", "from = \"first.toml\"\n");
    folder.write("job/first.toml", OF_ALL_KINDS.replace("clamp.stl", "../outside/clamp.stl"));
    assert_eq!(code(&folder, &earlier), "J0132");
    folder.write("job/job.toml", OF_ALL_KINDS);
    // A message about this text would show it.
    folder.write("outside/job.toml", "a secret");
    #[cfg(unix)]
    for input in INPUTS.iter().chain(&["job.toml"]) {
        with_link(&folder, input, &folder.place("outside").join(input), || {
            let file = JobFile::read(&inside.join("job.toml"), None);
            let code = file.err().map(|error| error.code());
            assert_eq!(code, Some("J0132"), "a link to {input}");
        });
    }
    // The user who runs the job allows more to be read. Outputs stay within its own folder.
    folder.root = Some(folder.folder.path().to_owned());
    for input in INPUTS {
        let changed = OF_ALL_KINDS.replace(&format!("\"{input}"), &format!("\"../outside/{input}"));
        assert_eq!(code(&folder, &changed), "", "{input}");
    }
    for (from, to, expected) in [
        ("rest.stl", "../rest.stl", "J0217"),
        ("rest.stl", "../outside/rest.stl", "J0217"),
        ("map.csv", "../map.csv", "J0217"),
        ("rest.stl", "rest", "J0218"),
        ("rest.stl", ".bashrc", "J0218"),
        ("map.csv", "a.nc", "J0218"),
        ("map.csv", "map.stl", "J0218"),
        ("map.csv", "map.PLY", ""),
        ("rest.stl", "new.STL", ""),
    ] {
        assert_eq!(code(&folder, &OF_ALL_KINDS.replace(from, to)), expected, "{to}");
    }
    #[cfg(unix)]
    for target in ["../outside/plate.stl", "../outside/none.stl", "a.nc", "none.stl"] {
        let link = inside.join("rest.stl");
        std::os::unix::fs::symlink(target, &link).expect("a link");
        assert_eq!(code(&folder, OF_ALL_KINDS), "J0217", "{target}");
        std::fs::remove_file(link).expect("removed");
    }
}

/// Names of folders are bytes, which need be no text.
#[test]
#[cfg(target_os = "linux")]
fn a_job_stands_in_a_folder_of_any_name() {
    use std::os::unix::ffi::OsStrExt;
    let folder = of_all_kinds();
    let head = "[[body]]\nname = \"head\"\nmoves_with = \"spindle\"\ntool = \"mill10.tool\"\nagainst = [\"the vice\"]\n";
    folder.write("job/m.toml", format!("{}\n{head}", machine("vice.stl")));
    folder.write("job/job.toml", OF_ALL_KINDS);
    let inside = folder.folder.path().join(std::ffi::OsStr::from_bytes(b"j\xff"));
    std::fs::rename(folder.place("job"), &inside).expect("renamed");
    let file = JobFile::read(&inside.join("job.toml"), None).expect("a job");
    let read =
        JobInputs::read::<ReadError>(file, |named| Ok(Loaded(Interpreted::load(&named.name)?)));
    read.expect("its files");
}

/// Files without end, and such that wait for a writer, are refused at once.
#[test]
#[cfg(unix)]
fn what_is_no_regular_file_is_not_read() {
    let folder = of_all_kinds();
    let (inside, root) = (folder.place("job"), Some(Path::new("/")));
    std::fs::write(inside.join("job.toml"), OF_ALL_KINDS).expect("written");
    assert!(
        std::process::Command::new("mkfifo")
            .arg(inside.join("pipe"))
            .status()
            .expect("mkfifo")
            .success()
    );
    for special in [Path::new("/dev/zero"), &*inside.join("pipe")] {
        // The file of the tool is read by the loader, which has a test of its own.
        let inputs = INPUTS.iter().filter(|input| **input != "mill10.tool");
        for input in inputs.chain(&["job.toml"]) {
            with_link(&folder, input, special, || {
                let read = JobFile::read(&inside.join("job.toml"), root)
                    .map_err(ReadError::Job)
                    .and_then(|file| {
                        JobInputs::read::<ReadError>(file, |named| {
                            Ok(Loaded(Interpreted::load(&named.name)?))
                        })
                    });
                let said = read.err().expect("a refusal").to_string();
                assert!(said.contains("no regular file"), "{input}: {said}");
            });
        }
    }
}

/// A slot in the side of a block, milled with the table tilted by 90 degrees.
const SLOT: &str = "G21 G90 G17 G40 G49 G80 G94\nG54\nT1 M6\nS6000 M3\nG0 A0. C0.\nG43 H1 X0. Y0. Z150.\nG0 A-90.\nM428\n\
    G0 X-80. Y100. Z-45.\nY58.\nG1 X80. F800.\nG0 Y100.\nM429\nM30\n";

const MILL_IN_HOLDER: &str = "tool Mill10 \"10 mm end mill in a holder\" { units mm; profile { start (0, 0); \
    line to (5, 0) as face cutting; line to (5, 30) as flute cutting; line to (5, 60) as shank; line to (14, 60), (14, 90), \
    (0, 90) as holder; } niceness cutting: 1; }";

/// Returns a folder with the slot, and its job.
fn slot() -> (Folder, String) {
    let folder = Folder::new();
    folder.cuboid("block.stl", [-60.0, -60.0, -60.0], [60.0, 60.0, 0.0]);
    folder.write("slot.nc", SLOT);
    folder.write("mill10.tool", MILL_IN_HOLDER);
    folder.write("linuxcnc.toml", rules("linuxcnc").to_toml());
    let job = "part = \"block.stl\"\nunit = \"mm\"\nprogram = \"slot.nc\"\nmachine = \"A-C trunnion with bodies\"\n\
               control = \"linuxcnc.toml\"\ntolerance = 2.1\n[work_offsets]\nG54 = [0, 0, -440]\n[tool.1]\ntool = \"mill10.tool\"\n\
               length = 95\n";
    (folder, job.to_owned())
}

/// The gauge point is at y = 58 + 95 of the tilted block, and the disc of the table reaches to 160: its prism to 160 / cos(π / 96).
#[test]
fn a_spindle_head_touches_the_table_at_a_steep_angle() {
    let (folder, job) = slot();
    let exact = 160.0 / (std::f64::consts::PI / 96.0).cos() - (58.0 + 95.0);
    let depth_of = |job: &str| {
        let depth = folder.with_report(job, |report| {
            let [finding] = report.findings() else { panic!("{:?}", report.findings()) };
            assert_eq!((finding.rule, finding.line), (FindingRule::Deep, 11), "{finding}");
            let FindingDetail::Surface { pair, groups, remedy, .. } = &finding.detail else {
                panic!("{finding}");
            };
            let pair = &report.pairs[*pair];
            let FindingKind::Deep { surface, depth, .. } = groups[0].worst.kind else {
                panic!("{finding}");
            };
            let head = report.revolved(pair).expect("a body of the machine");
            let surface = &*report.shape(pair).info().surface(surface).name;
            assert_eq!((&*head.name, surface), ("the spindle head", "nose"));
            assert_eq!(report.body(pair).name, "the table");
            (depth.high, remedy.lift.expect("a longer tool"))
        });
        depth.expect("a report")
    };
    let (depth, lift) = depth_of(&job);
    assert!((depth - exact).abs() < 1e-3, "{depth} {exact}");
    // The margin of the head is 1 mm.
    assert!((lift - exact - 1.0).abs() < 0.02, "{lift}");
    folder.gives(&job.replace("length = 95", "length = 104"), CLEAN, &[]);
    // The same machine without bodies has nothing to find.
    folder.gives(&job.replace(" with bodies", ""), CLEAN, &[]);
    // In inches the bodies are as large.
    let side = 60.0 / 25.4;
    folder.cuboid("inch.stl", [-side, -side, -side], [side, side, 0.0]);
    let inch = job.replace("\"mm\"", "\"inch\"").replace("block.stl", "inch.stl");
    let (depth, _) = depth_of(&inch.replace("tolerance = 2.1", "tolerance = 0.09"));
    assert!((25.4 * depth - exact).abs() < 2e-3, "{depth} {exact}");
}

/// An own machine has meshes and tools in files beside its own.
#[test]
fn an_own_machine_has_its_bodies_in_files() {
    let (folder, job) = slot();
    std::fs::create_dir(folder.place("shop")).expect("a folder");
    let machine = Machine::file("A-C trunnion with bodies").expect("a machine");
    let machine = machine.replace("name = \"A-C trunnion with bodies\"", "name = \"ours\"");
    let machine = machine.replace("tool = \"SpindleHead\"", "tool = \"head.tool\"");
    let disc = "cylinder = { radius = 160, height = 40 }\nposition = [0, 0, -540]\n";
    assert!(machine.contains(disc));
    let machine = machine.replace(disc, "mesh = \"table.stl\"\nposition = [0, 0, -500]\n");
    folder.write("shop/ours.toml", &machine);
    let head = "tool Head \"a head\" { units mm; profile { start (0, 0); line to (80, 0), (80, 300), (0, 300) as cover; } }";
    folder.write("shop/head.tool", head);
    folder.cuboid("shop/table.stl", [-155.0, -155.0, -40.0], [155.0, 155.0, 0.0]);
    let job = job.replace("A-C trunnion with bodies", "shop/ours.toml");
    folder.gives(&job, FINDINGS, &["V0101 the spindle head: cover is 2.0000 mm deep in the table"]);
    for (from, to, pattern) in [
        ("table.stl", "none.stl", "J0108 none.stl"),
        ("\"the table\", \"the cradle\"", "\"the tables\", \"the cradle\"", "K0307 the tables"),
        (
            "[220, 180, -560]]\nagainst = [\"tool\"]",
            "[220, 180, -560]]\nagainst = [\"part\"]",
            "K0310 the part",
        ),
    ] {
        assert!(machine.contains(from), "{from}");
        folder.write("shop/ours.toml", machine.replacen(from, to, 1));
        folder.gives(&job, NONE, &[pattern]);
    }
}

/// Bodies have no place without the origin of G54 and the lengths of the tools.
#[test]
fn bodies_need_the_place_of_the_part_and_the_lengths_of_tools() {
    let (folder, job) = slot();
    let job = job.replace("tolerance", "anyway = true\ntolerance");
    folder.refuses(&job, ["[work_offsets]\nG54 = [0, 0, -440]\n", ""], "J0117");
    folder.refuses(&job, ["length = 95\n", ""], "J0112 T1");
}

/// A fork head beside walls: its arms are beside the spindle, and reach lower than the pivot by their radius.
#[test]
fn an_arm_of_a_fork_head_touches_a_wall() {
    let folder = Folder::new();
    folder.cuboid("block.stl", [-60.0, -60.0, -60.0], [60.0, 60.0, 0.0]);
    folder.cuboid("walls.stl", [-170.0, -330.0, -60.0], [-110.0, 330.0, 53.0]);
    folder.write("mill10.tool", MILL_IN_HOLDER);
    folder.write("linuxcnc.toml", rules("linuxcnc").to_toml());
    let job = "part = \"block.stl\"\nunit = \"mm\"\nprogram = \"slot.nc\"\nmachine = \"A-C fork head with bodies\"\n\
               control = \"linuxcnc.toml\"\ntolerance = 2.1\n[work_offsets]\nG54 = [0, 0, -700]\n[tool.1]\ntool = \"mill10.tool\"\n\
               length = 95\n[[fixture]]\nname = \"the wall\"\nmesh = \"walls.stl\"\n";
    // The pivot is 95 + 220 mm from the tip, and at the cosine of the tilt above it: the arm's radius is 110.
    let clear = |angle: f64| 3.0 + 315.0 * f64::cos(angle.to_radians()) - 110.0 - 53.0 - 1.0;
    assert!(clear(59.0) > 0.1 && clear(61.0) < -4.0, "{} {}", clear(59.0), clear(61.0));
    for (tilt, verdict) in [(59.0, CLEAN), (-59.0, CLEAN), (61.0, FINDINGS), (-61.0, FINDINGS)] {
        let program = format!(
            "G21 G90 G54 G94 F800.\nT1 M6\nS6000 M3\nG0 A0. C0.\nG43 H1 X0. Y0. Z100.\nM428\nG0 X0. Y0. Z3.\nG1 A{tilt}\n\
             M429\nM30\n"
        );
        folder.write("slot.nc", program);
        let checked = folder.check(job);
        assert_eq!(checked.verdict, verdict, "{tilt}: {:#?}", checked.rows);
        let is_found = checked.has("V01 the left arm of the fork: arm is");
        assert_eq!(is_found, verdict == FINDINGS, "{tilt}: {:#?}", checked.rows);
        assert!(!checked.has("V01 the right arm") && !checked.has("V01 T1"), "{:#?}", checked.rows);
    }
}

/// Values of params, and keys of a job that name what there is not.
#[test]
fn a_wrong_job_is_refused_with_its_key() {
    let (folder, job) = slot();
    folder.cuboid("vise.stl", [-80.0, 70.0, -60.0], [80.0, 90.0, -40.0]);
    let job = job
        + "[[fixture]]\nname = \"the vise\"\nmesh = \"vise.stl\"\nmoves_with = \"C\"\n[stock]\n\
           box = [[-60, -60, -60], [60, 60, 0]]\nspacing = 2\n";
    folder.gives(&job, FINDINGS, &["V0101 the table"]);
    // Each finding has the name.
    let long = "v".repeat(101);
    for (change, pattern) in [
        (["the vise", &*long], "J0219"),
        (["unit = \"mm\"", "unit = \"yard\""], "J0202 yard"),
        (["tolerance = 2.1", "tolerances = 2.1"], "J0201 line 6: unknown field `tolerances`"),
        (["tolerance = 2.1", "tolerance = -1"], "J0203"),
        (["G54 = [", "G60 = ["], "J0106 `G60`"),
        (["[tool.1]", "[tool.4]"], "J0103 T1"),
        (["[tool.1]", "[tool.three]"], "J0206 `three`"),
        (["[tool.1]", "[tool.\"+1\"]"], "J0206 `+1`"),
        (["[tool.1]", "[tool.TT1]"], "J0206 `TT1`"),
        (["[stock]", "[presets]\n1 = \"G54\"\n01 = \"G55\"\n[stock]"], "J0212 `1`"),
        (["[stock]", "[variables]\n\"#500\" = 1\n\"0500\" = 2\n[stock]"], "J0221 #500"),
        (["[stock]", "[variables]\n\"#<_d>\" = 1\n\"#< _D >\" = 2\n[stock]"], "J0221 #<_d>"),
        (["[stock]", "[variables]\nR1 = 1\nr01 = 2\n[stock]"], "J0221 R1"),
        (["[stock]", "[variables]\nQL1 = 1\nql01 = 2\n[stock]"], "J0221 QL1"),
        (["[stock]", "[variables]\n\"#+500\" = 1\n[stock]"], "J0205 `#+500`"),
        (["[stock]", "[ignore]\nM05 = \"it stops nothing\"\n[stock]"], "K0504 M05"),
        (["the vise", "the part"], "J0222 the part"),
        (["the vise", "the stock"], "J0222 the stock"),
        (["A-C trunnion", "A-D trunnion"], "K0201 `A-D trunnion with bodies`"),
        (["A-C trunnion with bodies", "none.toml"], "J0101 none.toml"),
        (["moves_with = \"C\"", "moves_with = \"B\""], "J0122"),
        (["spacing = 2", "spacing = 0.001"], "J04 give a spacing of"),
        (["slot.nc", "none.nc"], "P0601 none.nc"),
    ] {
        folder.refuses(&job, change, pattern);
    }
    // A word that could move the tool stops the program with its line.
    for (word, pattern) in [
        ("G41 D7", "P0401 8 7"),
        ("IF [#1 EQ 1] GOTO 5", "P0 8"),
        ("L X+10 FMAX", "P0108 8"),
        ("G12.1", "P0115 8 G12.1"),
        ("B10.", "K0602 8 B"),
    ] {
        folder.write("slot.nc", SLOT.replace("M428", word));
        folder.gives(&job, NONE, &[pattern]);
    }
}
