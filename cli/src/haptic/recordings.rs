//! Recordings of a session: a table of its states, and a map of its postures.

use crate::failure::Failure;
use crate::output::unwritable;
use crate::postures::map::check_part;
use std::io::Write;
use std::path::{Path, PathBuf};
use touchoff::{AtomicFile, Mesh, Tool};
use touchoff_haptics::{SessionState, StateStream};
use touchoff_postures::{MapError, MapIdentity, PostureMap, Recorder, RecorderStats, Rules};

const COLUMNS: &str = "cycle,time_s,device_x,device_y,device_z,device_i,device_j,device_k,tool_x,tool_y,tool_z,\
    tool_i,tool_j,tool_k,force_x,force_y,force_z,torque_x,torque_y,torque_z,depth,contacts,energy_in,energy_stored";

/// A table of all states. The file takes its name when the session is over, and is `NAME.part` until then, which a killed session
/// leaves.
pub(super) struct Table {
    out: AtomicFile,
    file: PathBuf,
    rate: f64,
}

impl Table {
    pub(super) fn create(path: &Path, rate: f64) -> Result<Table, Failure> {
        let created = AtomicFile::create_kept(path).and_then(|mut out| {
            writeln!(out, "{COLUMNS}").and_then(|()| out.flush())?;
            Ok(out)
        });
        let out = created.map_err(|source| unwritable(path, source))?;
        Ok(Table { out, file: path.to_owned(), rate })
    }

    fn take(&mut self, state: &SessionState) -> std::io::Result<()> {
        let SessionState { cycle, wrench, wrench_on_hand: push, energy, .. } = state;
        let vectors = [
            state.device.tip().coords,
            state.device.axis(),
            state.tool.tip().coords,
            state.tool.axis(),
            push.force,
            push.torque,
        ];
        write!(self.out, "{cycle},{:.6}", *cycle as f64 / self.rate)?;
        for part in vectors.iter().flat_map(|vector| vector.iter()) {
            write!(self.out, ",{part}")?;
        }
        let (depth, colliding) = (wrench.depth(), wrench.colliding);
        writeln!(self.out, ",{depth},{colliding},{},{}", energy.input, energy.stored)
    }
}

/// The recordings of a session. One that cannot be written is reported at once and ends; the loop goes on.
pub(super) struct Recordings<'a> {
    table: Option<Table>,
    recorder: Option<Recorder<'a>>,
    failed: usize,
}

impl<'a> Recordings<'a> {
    pub(super) fn new(table: Option<Table>, recorder: Option<Recorder<'a>>) -> Recordings<'a> {
        Recordings { table, recorder, failed: 0 }
    }

    /// Takes the states that are available.
    pub(super) fn take(&mut self, samples: &mut StateStream) {
        for state in samples {
            let written = self.table.as_mut().map_or(Ok(()), |table| table.take(&state));
            self.table_written(written);
            let recorded =
                self.recorder.as_mut().map_or(Ok(()), |recorder| recorder.process(&state));
            self.recorded(recorded);
        }
        // Flushed here, so that a full disk is noticed at once and not only when a buffer is full.
        let written = self.table.as_mut().map_or(Ok(()), |table| table.out.flush());
        self.table_written(written);
    }

    fn table_written(&mut self, written: std::io::Result<()>) {
        if let Err(source) = written
            && let Some(table) = self.table.take()
        {
            self.failed += 1;
            message!(
                "error: {}; the recording of states stops here",
                unwritable(&table.file, source)
            );
        }
    }

    fn recorded(&mut self, recorded: Result<(), MapError>) {
        if let Err(error) = recorded {
            self.failed += 1;
            self.recorder = None;
            message!("error: {error}; the recording of postures stops here");
        }
    }

    /// Writes everything to the disk, and reports the outcome.
    ///
    /// # Errors
    /// If something could not be kept, now or before.
    pub(super) fn end(mut self) -> Result<(), Failure> {
        let recorded = self.recorder.as_mut().map_or(Ok(()), Recorder::write);
        self.recorded(recorded);
        if let Some(recorder) = &self.recorder {
            let RecorderStats { judged, accepted, skipped, .. } = recorder.stats();
            message!(
                "postures: {accepted} acceptable of {judged} validated; {skipped} states skipped"
            );
        }
        if let Some(Table { out, file, .. }) = self.table {
            out.commit().map_err(|source| unwritable(&file, source))?;
        }
        if self.failed > 0 { Err(Failure::RecordingFailed) } else { Ok(()) }
    }
}

/// Opens a map, or creates a new one for this part and tool, with the rules of a sweep.
pub(super) fn map_of(
    file: &Path,
    mesh: &Mesh,
    part: &Path,
    tool: &dyn Tool,
) -> Result<PostureMap, Failure> {
    if file.exists() {
        let map = PostureMap::resume(file)?;
        check_part(&map, file, mesh, part)?;
        return Ok(map);
    }
    let rules = Rules {
        tolerance: Rules::default_tolerance(mesh.unit()),
        niceness: 0.0,
        allowed: Vec::new(),
    };
    Ok(PostureMap::open(file, &MapIdentity::new(mesh, &[tool], rules)?)?)
}
