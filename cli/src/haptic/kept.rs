//! What is kept of a session: a table of its states, a map of its postures.

use crate::failure::Failure;
use crate::postures::map::check_part;
use crate::postures::usual;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;
use touchoff::haptic::{Samples, State};
use touchoff::postures::{Identity, PostureMap, Recorded, Recorder, Rules};
use touchoff::{Mesh, Tool};

const COLUMNS: &str = "cycle,seconds,device_x,device_y,device_z,device_i,device_j,device_k,tool_x,tool_y,tool_z,\
    tool_i,tool_j,tool_k,force_x,force_y,force_z,torque_x,torque_y,torque_z,depth,colliding,put_in,held";

/// All states, as a table.
pub(super) struct Table {
    out: BufWriter<File>,
    rate: f64,
}

impl Table {
    pub(super) fn create(path: &Path, rate: f64) -> Result<Table, Failure> {
        let wrong = |source| Failure::Record { file: path.display().to_string(), source };
        let mut out = BufWriter::new(File::create(path).map_err(wrong)?);
        writeln!(out, "{COLUMNS}").map_err(wrong)?;
        Ok(Table { out, rate })
    }

    fn take(&mut self, state: &State) -> std::io::Result<()> {
        let State { cycle, wrench, push, energy, .. } = state;
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
        writeln!(self.out, ",{depth},{colliding},{},{}", energy.put_in, energy.held)
    }
}

/// What is kept of a session.
pub(super) struct Kept<'a> {
    pub(super) table: Option<Table>,
    pub(super) recorder: Option<Recorder<'a>>,
}

impl Kept<'_> {
    /// Takes the states that there are.
    pub(super) fn take(&mut self, samples: &mut Samples) -> Result<(), Failure> {
        for state in samples {
            if let Some(table) = &mut self.table {
                table.take(&state)?;
            }
            if let Some(recorder) = &mut self.recorder {
                recorder.take(&state)?;
            }
        }
        Ok(())
    }

    /// Brings all of it to the disk, and says what came of it.
    pub(super) fn end(mut self) -> Result<(), Failure> {
        if let Some(table) = &mut self.table {
            table.out.flush()?;
        }
        if let Some(recorder) = &mut self.recorder {
            recorder.write()?;
            let Recorded { judged, accepted, skipped, .. } = recorder.seen();
            say!("postures: {accepted} acceptable of {judged} judged; {skipped} states not seen");
        }
        Ok(())
    }
}

/// The map of a file, or a new one of this part and tool: as a sweep would begin it.
pub(super) fn map_of(
    file: &Path,
    (mesh, part): (&Mesh, &Path),
    tool: &dyn Tool,
) -> Result<PostureMap, Failure> {
    if file.exists() {
        let map = PostureMap::read(file)?;
        check_part(&map, file, (mesh, part))?;
        return Ok(map);
    }
    let rules = Rules { tolerance: usual(mesh.unit()), niceness: 0.0, allowed: Vec::new() };
    Ok(PostureMap::open(file, &Identity::new(mesh, &[tool], rules)?)?)
}
