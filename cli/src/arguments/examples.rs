//! The examples at the end of each command's help text. A test takes them from there and runs them.

pub(super) const RUN: &str = "\
Examples:
  Depth, force and surfaces in contact at each pose, lengths in mm:
    touchoff run --part part.stl --unit mm --tool D2Ball --program program.apt
  A tool of your own with a diameter of 6 mm, and depth proved to a micrometre, as JSON:
    touchoff run --part part.stl --unit mm --tool my.tool --set D=6mm --program program.apt --certify 0.001 --json";

pub(super) const VERIFY: &str = "\
Examples:
  Find gouges deeper than 0.5 mm:
    touchoff verify --part part.stl --unit mm --tool D2Ball --program program.apt --tolerance 0.5
  Let the ball cut to any depth, and keep the shank 1 mm away from the part:
    touchoff verify --part part.stl --unit mm --tool D2Ball --program program.apt --allow ball=inf --allow shank=-1";

pub(super) const CONTROLS: &str = "\
Examples:
  What each control does:
    touchoff controls
  A control as a file, to edit and to name in a job as your own:
    touchoff controls haas";

pub(super) const MACHINES: &str = "\
Examples:
  Every machine, with limits, homes and pivots:
    touchoff machines
  A machine as a file, to edit and to name in a job as your own:
    touchoff machines 3-axis";

pub(super) const REPORT: &str = "\
Examples:
  Check a program, and write the report:
    touchoff report part.stl --unit mm --tool D2Ball --program program.apt --tolerance 0.5 -o report.html
  Also show from where tools reach the part, by a map that `touchoff sweep` made:
    touchoff report part.stl --unit mm --tool D2Ball --program program.apt --tolerance 0.5 --map part.postures -o report.html";

pub(super) const HAPTIC: &str = "\
Examples:
  A simulated hand presses a ball onto a place of the part with 1 N for 5 seconds:
    touchoff haptic --part part.stl --unit mm --tool D2Ball --at 1,2,0 --press 1 --duration 5
  Play a program once in 5 seconds, and record every state:
    touchoff haptic --part part.stl --unit mm --tool D2Ball --device playback --program program.apt --duration 5 --record states.csv";

pub(super) const LIVE: &str = "\
Examples:
  Touch a part with a 2 mm ball end mill in the browser:
    touchoff live --part part.stl --unit mm --tool D2Ball
  Only serve the page and print its address, with a tool of your own and a generated part:
    touchoff live --tool my.tool --no-open";

pub(super) const SWEEP: &str = "\
Examples:
  Find the postures of two tools to 0.05 mm from 50 directions per hemisphere, and keep them in a map:
    touchoff sweep --part part.stl --unit mm --tool D2Ball,BallEr16 --directions 50 --tolerance 0.05 -o part.postures
  Only summarise how much of the part a tool of your own reaches, with long triangles divided into pieces:
    touchoff sweep --part part.stl --unit mm --tool my.tool --directions 50 --refine 2";

pub(super) const MERGE: &str = "\
Examples:
  Join two shards, which `touchoff sweep` with `--shard 1/2 -o 1.parquet` and `--shard 2/2 -o 2.parquet` has written:
    touchoff merge 1.parquet 2.parquet -o merged.postures -o merged.parquet
  List the shards that are left:
    touchoff merge --left 1.parquet 2.parquet";

pub(super) const MAP: &str = "\
Examples:
  Summarise a map that `touchoff sweep` made:
    touchoff map part.postures
  Write it as a table, and as a picture of the directions from which the part can be reached:
    touchoff map part.postures --part part.stl --color-by accessibility -o map.csv -o map.png";

pub(super) const PATH: &str = "\
Examples:
  Write a program of lines 1 mm apart in planes across x:
    touchoff path part.postures --part part.stl --tool D2Ball --stepover 1 -o path.apt
  Follow horizontal planes instead, and write a table:
    touchoff path part.postures --part part.stl --tool D2Ball --plane-normal 0,0,1 --stepover 1 -o path.csv";

pub(super) const SAMPLE: &str = "\
Examples:
  Save 100,000 points of a part:
    touchoff sample --part part.stl --unit mm --points 100000 -o part.touchoff
  Save as many points as miss no depth above 0.05 mm:
    touchoff sample --part part.stl --unit mm --sampling-error 0.05 -o part.touchoff";

pub(super) const IMPORT: &str = "\
Examples:
  Import all tools of a library, and list them:
    touchoff import library.json -o tools
  Only list them:
    touchoff import library.json --list";

pub(super) const EXPORT: &str = "\
Examples:
  Write a built-in tool and one of your own as a library of Fusion 360:
    touchoff export D2Ball my.tool -o exported.json
  Write the cutter of a tool as a CUTTER statement of APT:
    touchoff export D2Ball -o cutter.apt";

pub(super) const TOOLS: &str = "\
Examples:
  List the built-in tools:
    touchoff tools
  List the tools of a library with their sizes and proofs:
    touchoff tools library.json";

pub(super) const TOOLS_LIST: &str = "\
Examples:
  List the built-in tools as JSON, one object per tool, lengths in the tool's unit:
    touchoff tools list --json
  List the tool of a file with a diameter of 6 mm, as JSON:
    touchoff tools list my.tool --set D=6mm --json";

pub(super) const TOOLS_SHOW: &str = "\
Examples:
  Print the text of a built-in tool:
    touchoff tools show D2Ball
  Write a tool in its holder to a file of your own, with the files that it mounts beside it:
    touchoff tools show BallEr16 -o ball_er16.tool";

pub(super) const CHECK: &str = "\
Examples:
  Errors, warnings and proved bounds of a tool:
    touchoff check my.tool
  All regions and borders, with a diameter of 6 mm:
    touchoff check my.tool --set D=6mm --verbose";

pub(super) const EXPLAIN: &str = "\
Examples:
  Explain the error T0201:
    touchoff explain T0201
  List all codes:
    touchoff explain";

pub(super) const FMT: &str = "\
Examples:
  Format a file in place:
    touchoff fmt my.tool
  Only name the files that are not in the standard layout:
    touchoff fmt --check my.tool";

pub(super) const EXPAND: &str = "\
Examples:
  Write the Rust code of a tool to a file:
    touchoff expand my.tool -o my.rs
  Print the decision tree of its regions for Graphviz:
    touchoff expand my.tool --stage plan";

pub(super) const DRAW: &str = "\
Examples:
  Draw the outline of a tool with a diameter of 6 mm, as PNG:
    touchoff draw my.tool --set D=6mm -o my.png
  Draw it with its regions, as SVG:
    touchoff draw my.tool --regions -o my.svg";
