//! Jobs in shards: each checks some of the motions, and names the tasks in which it has found something. The whole check then executes
//! these tasks alone.
//!
//! A task is 32 motions of a tool at a body, and its findings depend on these motions alone. What joins all motions is computed by the
//! whole check: the closest approach, the stock, the groups of findings. The result is hence the same as without shards, byte by byte.

use super::{Job, Program};
use crate::CutterLocation;
use crate::codes::faults;
use serde::{Deserialize, Serialize};
use siphasher::sip::SipHasher24;
use std::collections::BTreeSet;
use std::fmt::{self, Write};
use std::hash::Hasher;
use touchoff::{Shard, ShardSet, ShardSetError};

/// The version of the program, whose checks may differ from those of another.
const VERSION: &str = env!("CARGO_PKG_VERSION");

/// The tasks of a shard of a job in which there are findings. It is serialised for the machine that joins all shards.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct JobShard {
    /// The version of the program that has checked it.
    touchoff: String,
    shard: String,
    /// The digest of the job: program, tools, bodies and limits.
    job: String,
    /// The tasks with findings, per reading of the program and per pair of something that moves and a body.
    found: Vec<BTreeSet<usize>>,
    /// The digest of all of this.
    digest: String,
}

faults! {
    #[family("J03", "Jobs in shards")]
    /// A reason for which shards of a job are not joined.
    #[derive(Clone, PartialEq, thiserror::Error)]
    #[non_exhaustive]
    pub enum JobShardError {
        /// A shard is not what was written.
        #[code = J0301]
        #[error("{file} is damaged: check its shard again")]
        Damaged {
            /// The file.
            file: String,
        },
        /// A shard of another version.
        #[code = J0302]
        #[error(
            "{file} was written by version {version} of Touchoff, and this is {VERSION}: check its shard again"
        )]
        OtherVersion {
            /// The file.
            file: String,
            /// The version.
            version: String,
        },
        /// A shard of another job.
        #[code = J0303]
        #[error(
            "{file} is of another job: its program, tools, bodies or limits differ: check its shard again"
        )]
        OtherJob {
            /// The file.
            file: String,
        },
        /// A shard that does not go with the others.
        #[code = J0304]
        #[error(transparent)]
        Set(#[from] ShardSetError),
        /// Shards are missing.
        #[code = J0305]
        #[error("{left} of {count} shards are left, the first of them {first}: check them")]
        Incomplete {
            /// The number of missing shards.
            left: usize,
            /// The number of shards.
            count: u32,
            /// The first that is missing.
            first: Shard,
        },
    }
}

impl JobShard {
    pub(super) fn new(job: &Job<'_>, shard: Shard, found: Vec<BTreeSet<usize>>) -> JobShard {
        let (touchoff, digest) = (VERSION.to_owned(), String::new());
        let mut made =
            JobShard { touchoff, shard: shard.to_string(), job: digest_of(job), found, digest };
        made.digest = made.digest();
        made
    }

    /// Returns the number of tasks of 32 motions in which there are findings.
    pub fn tasks_with_findings(&self) -> usize {
        self.found.iter().map(BTreeSet::len).sum()
    }

    fn digest(&self) -> String {
        let JobShard { touchoff, shard, job, found, .. } = self;
        let mut text = HashedText(SipHasher24::new());
        text.add(format_args!("{touchoff} {shard} {job} {found:?}"));
        text.finish()
    }

    /// Joins all shards of a job: the tasks with findings, per reading and pair.
    ///
    /// # Errors
    /// If one is damaged, is of another job, version or number of shards, or is there twice; if some are missing.
    pub(super) fn join(
        job: &Job<'_>,
        shards: &[(String, JobShard)],
        pairs: usize,
    ) -> Result<Vec<BTreeSet<usize>>, JobShardError> {
        let expected = digest_of(job);
        let mut all = vec![BTreeSet::new(); pairs];
        let mut known = ShardSet::default();
        for (name, found) in shards {
            let file = || name.clone();
            if found.touchoff != VERSION {
                let version = found.touchoff.clone();
                return Err(JobShardError::OtherVersion { file: file(), version });
            }
            let shard = found.shard.parse().ok().filter(|_| found.digest == found.digest());
            let shard: Shard = shard.ok_or_else(|| JobShardError::Damaged { file: file() })?;
            if found.job != expected || found.found.len() != pairs {
                return Err(JobShardError::OtherJob { file: file() });
            }
            known.add(shard, name)?;
            for (all, found) in all.iter_mut().zip(&found.found) {
                all.extend(found);
            }
        }
        let mut left = known.left();
        match left.next().or_else(|| Shard::new(1, 1).filter(|_| shards.is_empty())) {
            Some(first) => {
                let (left, count) = (1 + left.count(), first.count());
                Err(JobShardError::Incomplete { left, count, first })
            }
            None => Ok(all),
        }
    }
}

/// A hasher of formatted text.
struct HashedText(SipHasher24);

impl Write for HashedText {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.0.write(text.as_bytes());
        Ok(())
    }
}

impl HashedText {
    fn add(&mut self, text: fmt::Arguments<'_>) {
        // Hashing does not fail. The byte ends the text.
        let _ = self.write_fmt(text);
        self.0.write_u8(0xff);
    }

    fn finish(self) -> String {
        format!("{:016x}", self.0.finish())
    }
}

/// Returns the digest of all that decides about findings, and of no path.
fn digest_of(job: &Job<'_>) -> String {
    // Each field is named here or left out on purpose.
    let Job {
        program,
        bodies,
        tools,
        revolved,
        stock: _,
        tolerance,
        resolution,
        allow,
        surface_only,
        gaps: _,
        anyway: _,
    } = job;
    let mut text = HashedText(SipHasher24::new());
    match program {
        Program::Locations(programs) => {
            for program in programs {
                text.add(format_args!("{:?} {:?}", program.unit, program.tool));
                for CutterLocation { line, pose, rapid, feed: _ } in &program.locations {
                    text.add(format_args!("{line} {pose:?} {rapid}"));
                }
            }
        }
        Program::Machine(readings) => {
            readings.iter().for_each(|reading| text.add(format_args!("{}", reading.identity())));
        }
    }
    for body in bodies {
        text.add(format_args!(
            "{} {} {:?} {:?} {:?}",
            body.name,
            body.bvh.unit(),
            body.frame,
            body.role,
            body.work_offset
        ));
        for corner in body.bvh.corners().flatten() {
            corner.coords.iter().for_each(|value| text.0.write_u64(value.to_bits()));
        }
    }
    for tool in tools {
        let digest = tool.tool.info().digest;
        text.add(format_args!("{:?} {digest:016x} {:?} {:?}", tool.motions, tool.hand, tool.allow));
    }
    for body in revolved {
        text.add(format_args!("{body:?} {:016x}", body.shape.info().digest));
    }
    text.add(format_args!("{tolerance:?} {resolution:?} {allow:?} {surface_only}"));
    text.finish()
}
