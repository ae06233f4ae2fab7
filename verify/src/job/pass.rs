//! The check of a job: one pass over each reading of the program, in which each motion goes to its tool at every body, and to the
//! stock.

use super::finding;
use super::machine::MachineFinding;
use super::program::BlockMoves;
use super::report::{JobReport, Moving, PairReport, Remedy};
use super::stock::{CutStock, StockCut};
use super::{Body, BodyFrame, Job, JobError, JobGap, JobTool};
use crate::check::{ApproachSearch, MoveCheck, MoveRequest};
use crate::gcode::{BlockLine, WorkOffset};
use crate::machine::{Link, Machine, Side};
use crate::{FindingGroup, MachineProgram, MachineSummary, Move, Verifier};
use std::collections::HashSet;
use std::sync::Arc;
use touchoff::tool::Symmetry;

/// Largest number of pairs of something that moves and a body. Each has a verifier and its findings in memory.
const MAX_PAIRS: usize = 10_000;

/// The results of one reading.
struct ReadingResult {
    /// Each tool at each body.
    pairs: Vec<PairReport>,
    /// The stock after it, if the job has one.
    cut: Option<CutStock>,
    /// The work offsets under which no tool comes near the part, with their blocks, if the reading has several.
    far_offsets: Vec<(WorkOffset, BlockLine)>,
}

/// Something that moves, and the index of the body against which it is checked.
#[derive(Clone, Copy)]
struct MovingPair {
    moving: Moving,
    body: usize,
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
    /// thread; the numbers add up to [`Job::motion_checks`].
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
        gaps.extend(self.gaps.iter().cloned());
        gaps.extend(self.contradicted_comments());
        let against = self.revolved.iter().flat_map(|body| &body.against);
        if against.into_iter().any(|body| *body >= self.bodies.len()) {
            return Err(JobError::NoSuchBody);
        }
        let (at_bodies, between) = self.pairs_of_each();
        let pairs_of_tools = self.tools.len().saturating_mul(at_bodies);
        if pairs_of_tools.saturating_add(between) > MAX_PAIRS {
            return Err(JobError::Pairs {
                moving: self.tools.len() + self.revolved.len(),
                bodies: self.bodies.len(),
                pairs: pairs_of_tools.saturating_add(between),
                limit: MAX_PAIRS,
            });
        }
        for (offset, line) in
            self.program.readings().iter().flat_map(|reading| &reading.summary().moved_offsets)
        {
            if self.bodies.iter().any(|body| body.work_offset == Some(*offset)) {
                return Err(JobError::MovedPart { offset: *offset, line: *line });
            }
        }
        let is_machine = |body: &Body<'_>| matches!(body.frame, BodyFrame::Machine(_));
        if !self.revolved.is_empty() || self.bodies.iter().any(is_machine) {
            self.program.check_places()?;
        } else if self.program.machine().is_some_and(|machine| !machine.bodies().is_empty()) {
            gaps.push(JobGap::MachineBodies.open(0));
        }
        let open = |block: BlockLine, gap: &JobGap| {
            let mut gap = gap.open(block);
            gap.reason += &self.program.name_within(block.within);
            gap
        };
        for (block, gap) in self.low_ways() {
            let gap = open(block, &gap);
            if !gaps.contains(&gap) {
                gaps.push(gap);
            }
        }
        for reading in 0..self.program.reading_count() {
            let result = self.check_reading(reading, progress)?;
            pairs.extend(result.pairs);
            let far = result.far_offsets.into_iter();
            let far = far.map(|(offset, block)| (block, JobGap::FarOffset { offset }));
            let of_stock = result.cut.iter().flat_map(|cut| cut.open.iter().cloned());
            for (block, gap) in far.chain(of_stock) {
                let gap = open(block, &gap);
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

    /// Returns the number of checks of motions at bodies, those of all readings together.
    pub fn motion_checks(&self) -> usize {
        let (at_bodies, between) = self.pairs_of_each();
        let summaries = self.program.readings().iter().map(MachineProgram::summary);
        let empty: usize = summaries.map(|summary| summary.empty_motions).sum();
        self.program.motions() * (at_bodies + between) + empty * between
    }

    /// Returns the number of bodies that a tool is checked against, and that of the pairs of all bodies of the machine.
    fn pairs_of_each(&self) -> (usize, usize) {
        let at_bodies = self.bodies.iter().filter(|body| body.meets_tools()).count();
        (at_bodies, self.revolved.iter().map(|body| body.against.len()).sum())
    }

    /// Returns what moves against which bodies: each tool, then each body of the machine.
    fn moving_pairs(&self) -> Vec<MovingPair> {
        let bodies = || self.bodies.iter().enumerate().filter(|(_, body)| body.meets_tools());
        let tools = (0..self.tools.len()).flat_map(|tool| {
            bodies().map(move |(body, _)| MovingPair { moving: Moving::Tool(tool), body })
        });
        let revolved = self.revolved.iter().enumerate().flat_map(|(index, moving)| {
            let moving_index = Moving::Revolved(index);
            moving.against.iter().map(move |body| MovingPair { moving: moving_index, body: *body })
        });
        tools.chain(revolved).collect()
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
        let moving = self.moving_pairs();
        // The moves that are asked for, those of the tools at the part first, and the index of those of each pair.
        let mut requests = vec![MoveRequest::AtPart];
        let mut request_of = Vec::new();
        let mut verifiers: Vec<Verifier<'a>> = Vec::new();
        for pair in &moving {
            let body = &self.bodies[pair.body];
            let revolved = match pair.moving {
                Moving::Tool(index) => {
                    verifiers.push(self.verifier(&self.tools[index], body)?);
                    None
                }
                Moving::Revolved(index) => {
                    let revolved = &self.revolved[index];
                    verifiers.push(self.verifier_between(revolved, body)?);
                    Some(revolved)
                }
            };
            let request = self.program.request(reading, revolved, body.frame)?;
            let known = requests.iter().position(|known| *known == request);
            request_of.push(known.unwrap_or(requests.len()));
            if known.is_none() {
                requests.push(request);
            }
        }
        let mut checks: Vec<MoveCheck<'_>> = Vec::new();
        let mut known: Option<(Moving, Arc<[f64]>)> = None;
        for (pair, verifier) in moving.iter().zip(&verifiers) {
            // The pairs of a tool follow each other.
            let max_depths = match &known {
                Some((moving, depths)) if *moving == pair.moving => depths.clone(),
                _ => verifier.max_depths()?,
            };
            known = Some((pair.moving, max_depths.clone()));
            let check = MoveCheck::new(verifier, max_depths)?;
            checks.push(check.with_other_parts(self.bodies.iter().filter_map(|b| b.work_offset)));
        }
        let offsets = match self.program.readings().get(reading) {
            Some(program) if program.summary().work_offsets.len() > 1 => {
                program.summary().work_offsets.clone()
            }
            _ => Vec::new(),
        };
        let mut approaches: Vec<OffsetApproach<'_>> = Vec::new();
        for (offset, _) in &offsets {
            // The part is the first body, unless another one stands at the offset.
            let other = self.bodies.iter().position(|body| body.work_offset == Some(*offset));
            let part = other.unwrap_or(0);
            for (pair, verifier) in
                moving.iter().zip(&verifiers).filter(|(pair, _)| pair.body == part)
            {
                let Some(tool) = pair.moving.tool() else { continue };
                let search = ApproachSearch::new(verifier)?;
                approaches.push(OffsetApproach { offset: *offset, tool, search, has_moves: false });
            }
        }
        let cut = self.stock.as_ref().map(|stock| StockCut::new(stock, self));
        let mut cut = cut.transpose()?;

        // A tool that makes all motions is not changed, whatever numbers the program has.
        let restarts = !self.tools.iter().any(|tool| tool.motions == crate::ToolSelection::All);
        // The machine's bodies move with every tool.
        let any_tool = (!self.revolved.is_empty()).then_some(Symmetry::Revolved);
        let blocks = self.program.blocks(reading, &requests, self.unit(), restarts, |number| {
            self.tool_of(number).map(|tool| tool.tool.info().symmetry).or(any_tool)
        })?;
        for BlockMoves { tool: number, frames } in blocks {
            let index = self.tool_index(number);
            for ((pair, request), check) in moving.iter().zip(&request_of).zip(&mut checks) {
                if pair.moving.tool().is_some() && pair.moving.tool() != index {
                    continue;
                }
                for step in &frames[*request] {
                    check.add(step.clone(), progress)?;
                }
            }
            let Some(index) = index else { continue };
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
        for ((MovingPair { moving, body }, verifier), check) in
            moving.into_iter().zip(&verifiers).zip(checks)
        {
            let report = check.finish(progress)?;
            let groups = FindingGroup::join(&report.findings);
            let remedies =
                groups.iter().map(|group| self.remedy(verifier, moving, body, reading, group));
            let remedies = remedies.collect();
            pairs.push(PairReport { moving, body, reading, report, groups, remedies });
        }
        // An offset of another part, or with a wrong origin, is one under which no tool comes near this part.
        let near = approaches.into_iter().filter_map(OffsetApproach::finish_near);
        let near: Vec<WorkOffset> = near.collect();
        let far_offsets =
            offsets.into_iter().filter(|(offset, _)| !near.contains(offset)).collect();
        Ok(ReadingResult { pairs, cut: cut.map(StockCut::finish), far_offsets })
    }

    /// Returns the changes that clear the worst motion of a group: a travel along the axis where a longer tool makes it, and a tilt of
    /// a tool.
    fn remedy(
        &self,
        verifier: &Verifier<'_>,
        moving: Moving,
        body: usize,
        reading: usize,
        group: &FindingGroup,
    ) -> Remedy {
        let machine = self.program.machine();
        // A body that the head carries follows the tool.
        let is_carried = |machine: &Machine| match self.bodies[body].frame.link(machine) {
            Link::Base => false,
            Link::Axis(letter) => machine.axis(letter).is_some_and(|axis| axis.side == Side::Tool),
        };
        if machine.is_some_and(is_carried) {
            return Remedy { lift: None, tilt: None };
        }
        let reading = self.program.readings().get(reading);
        let is_of = |blocks: fn(&MachineSummary) -> &HashSet<BlockLine>| {
            let block = group.worst.block();
            reading.is_some_and(|reading| blocks(reading.summary()).contains(&block))
        };
        match moving {
            Moving::Tool(_) => Remedy {
                lift: verifier.lift(&group.worst),
                tilt: verifier.tilt(&group.worst).filter(|_| self.program.turns_axis()),
            },
            Moving::Revolved(index) => {
                let revolved = &self.revolved[index];
                // In an empty spindle no tool could be longer.
                let is_empty = is_of(|summary| &summary.empty_blocks);
                // A longer tool lifts nothing without a length offset.
                let is_lifted = !is_empty
                    && !is_of(|summary| &summary.bare_blocks)
                    && machine.is_some_and(|machine| revolved.is_lifted_by_length(machine));
                let lift = if is_lifted { verifier.lift(&group.worst) } else { None };
                Remedy { lift, tilt: None }
            }
        }
    }

    /// Returns the tool that makes the motions of a number.
    pub(super) fn tool_of(&self, number: Option<u32>) -> Option<&JobTool<'a>> {
        Some(&self.tools[self.tool_index(number)?])
    }

    fn tool_index(&self, number: Option<u32>) -> Option<usize> {
        self.tools.iter().position(|tool| tool.motions.contains(number))
    }
}
