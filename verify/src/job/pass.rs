//! The check of a job: one pass over each reading of the program, in which each motion goes to its tool at every body, and to the
//! stock.

use super::finding;
use super::machine::MachineFinding;
use super::program::BlockMoves;
use super::report::{JobReport, PairReport, Remedy};
use super::stock::{CutStock, StockCut};
use super::{Job, JobError, JobTool};
use crate::check::{ApproachSearch, MoveCheck};
use crate::gcode::WorkOffset;
use crate::{FindingGroup, Gap, Move, Verifier};

/// The results of one reading.
struct ReadingResult {
    /// Each tool at each body.
    pairs: Vec<PairReport>,
    /// The stock after it, if the job has one.
    cut: Option<CutStock>,
    /// The work offsets under which no tool comes near the part, with their lines, if the reading has several.
    far_offsets: Vec<(WorkOffset, usize)>,
}

/// The closest approach to the part under one work offset, of one tool.
struct OffsetApproach<'a> {
    offset: WorkOffset,
    /// The index of the tool.
    tool: usize,
    search: ApproachSearch<'a>,
    has_moves: bool,
}

impl OffsetApproach<'_> {
    /// Returns the offset, if the tool comes near the part under it.
    fn finish_near(self) -> Option<WorkOffset> {
        (self.has_moves && !self.search.finish().is_far()).then_some(self.offset)
    }

    /// Adds the moves under the offset.
    fn add(&mut self, moves: &[Move]) {
        for step in moves.iter().filter(|step| step.work_offset == Some(self.offset)) {
            self.search.add(std::slice::from_ref(step), &[]);
            self.has_moves = true;
        }
    }
}

impl<'a> Job<'a> {
    /// Checks the program in every reading. `progress` is called with the number of motions checked since the last call, from any
    /// thread; the numbers add up to [`Program::motions`](super::Program::motions) times the number of bodies.
    ///
    /// # Errors
    /// If the program states another unit or cutter than the job, a tool cannot be certified or has not a surface that is allowed a
    /// depth, or the stock cannot be made or cut.
    pub fn check(&self, progress: &(dyn Fn(usize) + Sync)) -> Result<JobReport<'_>, JobError> {
        for JobTool { motions, tool, .. } in &self.tools {
            self.program.check_tool(*motions, tool.info(), self.unit())?;
        }
        let (mut pairs, mut cuts) = (Vec::new(), Vec::new());
        let mut gaps = self.program.gaps();
        let mut readings = self.program.readings().iter();
        if let (Some(line), Some(_)) =
            (readings.find_map(|reading| reading.summary().any_rapid), &self.stock)
        {
            let reason = "the path of several axes in rapid traverse is checked against the stock on the straight line only: \
                          state `rapid` of the control, or the `rapid` rates of the machine's axes";
            gaps.push(Gap::open(line, reason.to_owned()));
        }
        for reading in 0..self.program.reading_count() {
            let result = self.check_reading(reading, progress)?;
            pairs.extend(result.pairs);
            let far = result.far_offsets.into_iter().map(|(offset, line)| {
                let reason = format!(
                    "under {offset} the tool never comes within its diameter of the part: check {offset} in `work_offsets`, \
                     or give a job per part"
                );
                (line, reason)
            });
            let thin = result.cut.iter().flat_map(|cut| cut.too_thin.iter().cloned());
            for (line, reason) in far.chain(thin) {
                let gap = Gap::open(line, reason);
                if !gaps.contains(&gap) {
                    gaps.push(gap);
                }
            }
            cuts.extend(result.cut);
        }
        gaps.sort_by_key(|gap| (gap.weight, gap.line));
        let machine = MachineFinding::all(self);
        let mut report = JobReport { job: self, pairs, machine, cuts, gaps, findings: Vec::new() };
        report.findings = finding::all(&report);
        Ok(report)
    }

    /// Checks one reading of the program.
    ///
    /// # Errors
    /// If a tool cannot be certified, a body's link is not the machine's, or the stock cannot be made or cut.
    fn check_reading(
        &self,
        reading: usize,
        progress: &(dyn Fn(usize) + Sync),
    ) -> Result<ReadingResult, JobError> {
        // The links of the bodies, that of the part first, and the index of that of each body.
        let mut links: Vec<Option<usize>> = Vec::new();
        let mut frame_of = Vec::new();
        for body in &self.bodies {
            let known = links.iter().position(|link| *link == body.link);
            frame_of.push(known.unwrap_or(links.len()));
            if known.is_none() {
                links.push(body.link);
            }
        }
        // Tool by tool, each at every body: the index of a pair follows from those of both.
        let mut verifiers: Vec<Verifier<'a>> = Vec::new();
        for tool in &self.tools {
            for body in &self.bodies {
                verifiers.push(self.verifier(tool, body)?);
            }
        }
        let checks = verifiers.iter().map(MoveCheck::new);
        let mut checks: Vec<MoveCheck<'_>> = checks.collect::<Result<_, _>>()?;
        let offsets = match self.program.readings().get(reading) {
            Some(program) if program.summary().work_offsets.len() > 1 => {
                program.summary().work_offsets.clone()
            }
            _ => Vec::new(),
        };
        let mut approaches: Vec<OffsetApproach<'_>> = Vec::new();
        for (offset, _) in &offsets {
            // The part is the first body.
            for (tool, verifier) in verifiers.iter().step_by(self.bodies.len()).enumerate() {
                let search = ApproachSearch::new(verifier)?;
                approaches.push(OffsetApproach { offset: *offset, tool, search, has_moves: false });
            }
        }
        let mut cut = match &self.stock {
            Some(stock) => Some(StockCut::new(stock, self)?),
            None => None,
        };

        // A tool that makes all motions is not changed, whatever numbers the program has.
        let restarts = !self.tools.iter().any(|tool| tool.motions == crate::ToolSelection::All);
        let blocks = self.program.blocks(reading, &links, self.unit(), restarts, |number| {
            Some(self.tool_of(number)?.tool.info().symmetry)
        })?;
        for BlockMoves { tool: number, frames } in blocks {
            let Some(index) = self.tool_index(number) else { continue };
            for (frame, check) in frame_of.iter().zip(&mut checks[index * self.bodies.len()..]) {
                for step in &frames[*frame] {
                    check.add(step.clone(), progress)?;
                }
            }
            for approach in approaches.iter_mut().filter(|approach| approach.tool == index) {
                approach.add(&frames[0]);
            }
            if let Some(cut) = &mut cut {
                for step in &frames[0] {
                    cut.advance(&self.tools[index], step)?;
                }
            }
        }

        let mut pairs = Vec::new();
        for (index, (verifier, check)) in verifiers.iter().zip(checks).enumerate() {
            let report = check.finish(progress)?;
            let groups = FindingGroup::join(&report.findings);
            let remedies = groups
                .iter()
                .map(|group| Remedy {
                    lift: verifier.lift(&group.worst),
                    tilt: verifier.tilt(&group.worst).filter(|_| self.program.turns_axis()),
                })
                .collect();
            let (tool, body) = (index / self.bodies.len(), index % self.bodies.len());
            pairs.push(PairReport { tool, body, reading, report, groups, remedies });
        }
        // An offset of another part, or with a wrong origin, is one under which no tool comes near this part.
        let near = approaches.into_iter().filter_map(OffsetApproach::finish_near);
        let near: Vec<WorkOffset> = near.collect();
        let far_offsets =
            offsets.into_iter().filter(|(offset, _)| !near.contains(offset)).collect();
        Ok(ReadingResult { pairs, cut: cut.map(StockCut::finish), far_offsets })
    }

    /// Returns the tool that makes the motions of a number.
    pub(super) fn tool_of(&self, number: Option<u32>) -> Option<&JobTool<'a>> {
        Some(&self.tools[self.tool_index(number)?])
    }

    fn tool_index(&self, number: Option<u32>) -> Option<usize> {
        self.tools.iter().position(|tool| tool.motions.contains(number))
    }
}
