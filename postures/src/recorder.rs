//! Recording of postures found by hand in the haptic loop, while it runs.

use super::{MapError, PostureMap, PostureRecord, Validator, ValidatorError};
use std::fmt;
use std::time::{Duration, Instant};
use touchoff::certify::TriangleBvh;
use touchoff::{Part, Pose, Probe, Tool, TriangleId, Unit};
use touchoff_haptics::{SessionState, StateStream};

/// Takes the states of a running loop, and records those poses that are nice and proved acceptable.
///
/// Its only link to the loop is the ring that [`state_channel`](touchoff_haptics::state_channel) makes; the loop
/// never waits for it. States that come faster than they are validated fall out of the ring and are counted.
/// Run it in a thread of its own, until the loop's [`StatePublisher`](touchoff_haptics::StatePublisher) is
/// dropped.
pub struct Recorder<'a> {
    map: &'a PostureMap,
    tool: u16,
    probe: Probe<'a>,
    validator: Validator<'a>,
    /// Niceness per triangle that a posture needs to be offered to the map.
    required_niceness: Vec<f64>,
    batch: Vec<(TriangleId, PostureRecord)>,
    /// Arrival time of the first posture of the batch.
    batch_start: Instant,
    /// The pose of the last state.
    last_pose: Option<Pose>,
    /// The cycle that is expected next.
    next_cycle: Option<u64>,
    stats: RecorderStats,
}

impl fmt::Debug for Recorder<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Recorder")
            .field("tool", &self.tool)
            .field("stats", &self.stats)
            .finish_non_exhaustive()
    }
}

/// Counters of a recorder.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct RecorderStats {
    /// States that were taken.
    pub states: u64,
    /// Cycles between those states that were missed: the ring was full, or they had no state.
    pub skipped: u64,
    /// Poses that could have improved a triangle's row, and were validated.
    pub judged: u64,
    /// Validated poses that were acceptable.
    pub accepted: u64,
    /// Transactions.
    pub batches: u64,
}

/// A reason for which a recorder cannot be created.
#[derive(thiserror::Error)]
#[non_exhaustive]
pub enum RecorderError {
    /// The tool is not one of the map's.
    #[error(
        "{tool} is no tool of the map, which has {known}: open the map with this version of the tool among its own"
    )]
    Tool {
        /// The tool's name.
        tool: String,
        /// The names of the map's tools.
        known: String,
    },
    /// The point cloud or the triangles of the part are in another unit than the map.
    #[error("the map is in {map}, and the part beside it in {part}: make both from the same mesh")]
    Unit {
        /// The map's unit.
        map: Unit,
        /// The part's unit.
        part: Unit,
    },
    /// The tool's postures cannot be validated.
    #[error(transparent)]
    Validator(#[from] ValidatorError),
    /// The map cannot be read.
    #[error(transparent)]
    Map(#[from] MapError),
}

touchoff::debug_as_sentence!(RecorderError);

/// Number of records at which a batch is written to disk.
const MAX_BATCH_RECORDS: usize = 4096;
/// Age at which a batch is written to disk.
const MAX_BATCH_AGE: Duration = Duration::from_millis(500);
/// Time between two looks at the ring.
const POLL_INTERVAL: Duration = Duration::from_millis(2);

impl<'a> Recorder<'a> {
    /// Creates a recorder into a map, for a tool at the map's part, given both as points and as triangles.
    ///
    /// # Errors
    /// If the tool is not one of the map's or cannot be validated; if the part is in another unit; if the map
    /// cannot be read.
    pub fn new(
        map: &'a PostureMap,
        part: &'a Part,
        bvh: &'a TriangleBvh,
        tool: &'a dyn Tool,
    ) -> Result<Recorder<'a>, RecorderError> {
        let (info, identity) = (tool.info(), map.identity());
        let index = identity.tool(info).ok_or_else(|| RecorderError::Tool {
            tool: info.name.to_string(),
            known: identity.tool_names(),
        })?;
        for unit in [part.unit(), bvh.unit()] {
            if unit != identity.part.unit {
                return Err(RecorderError::Unit { map: identity.part.unit, part: unit });
            }
        }
        let mut recorder = Recorder {
            map,
            tool: index,
            probe: Probe::new(part, tool),
            validator: Validator::new(bvh, tool, &identity.rules)?,
            required_niceness: vec![f64::NEG_INFINITY; identity.part.triangles as usize],
            batch: Vec::new(),
            batch_start: Instant::now(),
            last_pose: None,
            next_cycle: None,
            stats: RecorderStats::default(),
        };
        for entry in map.rows()? {
            let (triangle, row) = entry?;
            recorder.update_required(triangle, &row.best);
        }
        Ok(recorder)
    }

    /// Takes all states until the loop is over, and returns the counters. By then all accepted postures are on
    /// disk.
    ///
    /// # Errors
    /// If the map cannot be written or read. The loop goes on, and earlier records are safe.
    pub fn follow(&mut self, samples: &mut StateStream) -> Result<RecorderStats, MapError> {
        loop {
            // Query before reading, so that states published before the end are still taken.
            let closed = samples.is_closed();
            for state in samples.by_ref() {
                self.process(&state)?;
            }
            if closed {
                self.write()?;
                return Ok(self.stats);
            }
            if !self.batch.is_empty() && self.batch_start.elapsed() > MAX_BATCH_AGE {
                self.write()?;
            }
            std::thread::sleep(POLL_INTERVAL);
        }
    }

    /// Takes one state.
    ///
    /// # Errors
    /// If the map cannot be written or read.
    pub fn process(&mut self, state: &SessionState) -> Result<(), MapError> {
        self.stats.states += 1;
        self.stats.skipped +=
            self.next_cycle.map_or(0, |next_cycle| state.cycle.saturating_sub(next_cycle));
        self.next_cycle = Some(state.cycle + 1);
        let unmoved = self.last_pose.replace(state.tool) == Some(state.tool);
        if unmoved || state.wrench.colliding == 0 {
            return Ok(());
        }
        // Use the pose as it would be recorded: by tip and axis, without spin.
        let Ok(pose) = Pose::from_axis(state.tool.tip(), state.tool.axis()) else { return Ok(()) };
        let contacts = self.probe.contacts(&pose);
        let niceness =
            contacts.iter().map(|contact| contact.niceness).fold(f64::INFINITY, f64::min);
        let mut touched: Vec<TriangleId> =
            contacts.iter().map(|contact| contact.triangle).collect();
        touched.sort_unstable();
        touched.dedup();
        // Most poses cannot improve any row, and are not worth a proof.
        touched.retain(|triangle| {
            let required = self.required_niceness.get(triangle.index());
            required.is_none_or(|required| niceness >= *required)
        });
        if touched.is_empty() || niceness < self.map.identity().rules.niceness {
            return Ok(());
        }
        self.stats.judged += 1;
        let Some(record) = self.validator.record(self.tool, &state.tool, niceness) else {
            return Ok(());
        };
        self.stats.accepted += 1;
        if self.batch.is_empty() {
            self.batch_start = Instant::now();
        }
        self.batch.extend(touched.into_iter().map(|triangle| (triangle, record)));
        if self.batch.len() >= MAX_BATCH_RECORDS || self.batch_start.elapsed() > MAX_BATCH_AGE {
            self.write()
        } else {
            Ok(())
        }
    }

    /// Returns the counters so far.
    pub fn stats(&self) -> RecorderStats {
        self.stats
    }

    /// Writes the batch to disk.
    ///
    /// # Errors
    /// If the map cannot be written or read.
    pub fn write(&mut self) -> Result<(), MapError> {
        if self.batch.is_empty() {
            return Ok(());
        }
        self.map.merge(&self.batch)?;
        self.stats.batches += 1;
        // The rows that were merged into may require more now.
        let mut triangles: Vec<TriangleId> =
            self.batch.drain(..).map(|(triangle, _)| triangle).collect();
        triangles.sort_unstable();
        triangles.dedup();
        for triangle in triangles {
            if let Some(row) = self.map.row(triangle)? {
                self.update_required(triangle, &row.best);
            }
        }
        Ok(())
    }

    /// Updates the niceness that a triangle requires: that of its last posture, once it has as many as are
    /// kept.
    fn update_required(&mut self, triangle: TriangleId, best: &[PostureRecord]) {
        let last = best.get(usize::from(self.map.identity().keep.get()) - 1);
        self.required_niceness[triangle.index()] =
            last.map_or(f64::NEG_INFINITY, |record| record.niceness);
    }
}
