//! What a hand finds in the haptic loop, taken in while it is looking.

use super::{Judge, JudgeError, MapError, PostureMap, Record, ToolStamp};
use crate::certify::Facets;
use crate::escape::Escaped;
use crate::haptic::{Samples, State};
use crate::part::Part;
use crate::pose::Pose;
use crate::probe::Probe;
use crate::tool::Tool;
use crate::unit::Unit;
use std::time::{Duration, Instant};

/// Takes the poses of a running loop, and records those that are nice and proved acceptable.
///
/// Between it and the loop is the ring that [`watched`](crate::haptic::watched) makes, and nothing else: the
/// loop never waits for it. What comes faster than it judges falls out of the ring and is counted. Run it in
/// a thread of its own, until the loop's [`Watch`](crate::haptic::Watch) is dropped.
pub struct Recorder<'a> {
    map: &'a PostureMap,
    tool: u16,
    probe: Probe<'a>,
    judge: Judge<'a>,
    /// How nice a posture has to be so that it may better a triangle's.
    wanted: Vec<f64>,
    batch: Vec<(u32, Record)>,
    /// When the first of the batch came.
    since: Instant,
    /// The pose before, and the next cycle.
    before: Option<Pose>,
    next: Option<u64>,
    seen: Recorded,
}

/// What a recorder saw.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Recorded {
    /// States that it took.
    pub states: u64,
    /// Cycles between them that it did not see: the ring was full, or they had no state.
    pub skipped: u64,
    /// Poses that could have bettered a triangle, and were judged.
    pub judged: u64,
    /// Those of them that were acceptable.
    pub accepted: u64,
    /// Transactions.
    pub batches: u64,
}

/// Why there is no recorder.
#[derive(Debug, thiserror::Error)]
pub enum RecorderError {
    /// The tool is none of the map's.
    #[error(
        "{tool} is no tool of the map, which has {known}: open the map with this version of the tool among its own"
    )]
    Tool {
        /// Its name.
        tool: String,
        /// Those that the map has.
        known: String,
    },
    /// The part that is felt, or the triangles, are in another unit than the map.
    #[error("the map is in {map}, and the part beside it in {part}: make both from the same mesh")]
    Unit {
        /// The map's.
        map: Unit,
        /// The part's.
        part: Unit,
    },
    /// The tool cannot be judged.
    #[error(transparent)]
    Judge(#[from] JudgeError),
    /// The map cannot be read.
    #[error(transparent)]
    Map(#[from] MapError),
}

/// A batch goes to the disk when it has so many, or is so old.
const MANY: usize = 4096;
const OLD: Duration = Duration::from_millis(500);
/// How long to wait for more.
const PAUSE: Duration = Duration::from_millis(2);

impl<'a> Recorder<'a> {
    /// A recorder into a map, of a tool at the map's part, both as points and as triangles.
    ///
    /// # Errors
    /// If the tool is none of the map's or cannot be judged; if the part is in another unit; if the map cannot
    /// be read.
    pub fn new(
        map: &'a PostureMap,
        (part, facets): (&'a Part, &'a Facets),
        tool: &'a dyn Tool,
    ) -> Result<Recorder<'a>, RecorderError> {
        let (card, identity) = (tool.card(), map.identity());
        let place = identity.tool(card).ok_or_else(|| {
            let name = |tool: &ToolStamp| format!("`{}`", Escaped(&tool.name));
            let known: Vec<String> = identity.tools.iter().map(name).collect();
            RecorderError::Tool { tool: card.name.to_string(), known: known.join(", ") }
        })?;
        for unit in [part.unit(), facets.unit()] {
            if unit != identity.part.unit {
                return Err(RecorderError::Unit { map: identity.part.unit, part: unit });
            }
        }
        let mut recorder = Recorder {
            map,
            tool: place,
            probe: Probe::new(part, tool),
            judge: Judge::new(facets, tool, &identity.rules)?,
            wanted: vec![f64::NEG_INFINITY; identity.part.triangles as usize],
            batch: Vec::new(),
            since: Instant::now(),
            before: None,
            next: None,
            seen: Recorded::default(),
        };
        for entry in map.rows()? {
            let (triangle, row) = entry?;
            recorder.note(triangle, &row.best);
        }
        Ok(recorder)
    }

    /// Takes all states until the loop is over, and says what it saw so far. All that it took in is on the
    /// disk then.
    ///
    /// # Errors
    /// If the map cannot be written or read. The loop goes on; what was recorded before is safe.
    pub fn follow(&mut self, samples: &mut Samples) -> Result<Recorded, MapError> {
        loop {
            // Asked first: what comes before the end is taken.
            let over = samples.are_all();
            for state in samples.by_ref() {
                self.take(&state)?;
            }
            if over {
                self.write()?;
                return Ok(self.seen);
            }
            if !self.batch.is_empty() && self.since.elapsed() > OLD {
                self.write()?;
            }
            std::thread::sleep(PAUSE);
        }
    }

    /// Takes one state.
    ///
    /// # Errors
    /// If the map cannot be written or read.
    pub fn take(&mut self, state: &State) -> Result<(), MapError> {
        self.seen.states += 1;
        self.seen.skipped += self.next.map_or(0, |next| state.cycle.saturating_sub(next));
        self.next = Some(state.cycle + 1);
        let same = self.before.replace(state.tool) == Some(state.tool);
        if same || state.wrench.colliding == 0 {
            return Ok(());
        }
        // As it will be told: by tip and axis.
        let Ok(pose) = Pose::from_axis(state.tool.tip(), state.tool.axis()) else { return Ok(()) };
        let contacts = self.probe.contacts(&pose);
        let niceness =
            contacts.iter().map(|contact| contact.niceness).fold(f64::INFINITY, f64::min);
        let mut touched: Vec<u32> = contacts.iter().map(|contact| contact.triangle).collect();
        touched.sort_unstable();
        touched.dedup();
        let wanted = &self.wanted;
        let better = |triangle: &u32| {
            wanted.get(*triangle as usize).is_none_or(|wanted| niceness >= *wanted)
        };
        touched.retain(better);
        if touched.is_empty() || niceness < self.map.identity().rules.niceness {
            return Ok(());
        }
        self.seen.judged += 1;
        let Some(record) = self.judge.record(self.tool, &state.tool, niceness) else {
            return Ok(());
        };
        self.seen.accepted += 1;
        if self.batch.is_empty() {
            self.since = Instant::now();
        }
        self.batch.extend(touched.into_iter().map(|triangle| (triangle, record)));
        if self.batch.len() >= MANY || self.since.elapsed() > OLD { self.write() } else { Ok(()) }
    }

    /// What it saw so far.
    pub fn seen(&self) -> Recorded {
        self.seen
    }

    /// Brings the batch to the disk.
    ///
    /// # Errors
    /// If the map cannot be written or read.
    pub fn write(&mut self) -> Result<(), MapError> {
        if self.batch.is_empty() {
            return Ok(());
        }
        self.map.offer(&self.batch)?;
        self.seen.batches += 1;
        let mut triangles: Vec<u32> = self.batch.drain(..).map(|(triangle, _)| triangle).collect();
        triangles.sort_unstable();
        triangles.dedup();
        for triangle in triangles {
            if let Some(row) = self.map.row(triangle)? {
                self.note(triangle, &row.best);
            }
        }
        Ok(())
    }

    /// What a triangle has, once it has as many as are kept, is to be bettered.
    fn note(&mut self, triangle: u32, best: &[Record]) {
        let last = best.get(usize::from(self.map.identity().keep.get()) - 1);
        self.wanted[triangle as usize] = last.map_or(f64::NEG_INFINITY, |record| record.niceness);
    }
}
