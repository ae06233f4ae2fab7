//! What a thread can ask the system for, so that nothing else comes between its cycles.

#[cfg(unix)]
use thread_priority::{
    RealtimeThreadSchedulePolicy, ThreadPriority, ThreadPriorityValue, ThreadSchedulePolicy,
    set_thread_priority_and_policy, thread_native_id,
};

use std::fmt;

/// What is asked for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Realtime {
    /// Before all threads that have no such priority, from 1 to 99: first in, first out.
    pub priority: Option<u8>,
    /// Only on that core, counted from 0.
    pub core: Option<usize>,
    /// With all of the process's memory kept in place.
    pub locked: bool,
}

/// Something that the system did not grant. The loop runs without it.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Refused {
    /// The priority.
    #[error("no real-time priority ({0}): start as root, or allow it with `ulimit -r`")]
    Priority(String),
    /// The core.
    #[error("not kept on core {core}: this process may run on {}", Listed(.cores))]
    Core {
        /// The core that was asked for.
        core: usize,
        /// Those that there are for this process, in ascending order.
        cores: Vec<usize>,
    },
    /// The memory.
    #[error("memory is not locked ({0}): start as root, or allow it with `ulimit -l`")]
    Memory(String),
}

impl Realtime {
    /// Asks for it, for the thread that calls. What was refused is said; the rest holds.
    pub fn ask(&self) -> Vec<Refused> {
        let mut refused = Vec::new();
        if let Some(core) = self.core
            && let Err(error) = stay_on(core)
        {
            refused.push(error);
        }
        if self.locked
            && let Err(error) = memory()
        {
            refused.push(Refused::Memory(error));
        }
        if let Some(priority) = self.priority
            && let Err(error) = first(priority)
        {
            refused.push(Refused::Priority(error));
        }
        refused
    }
}

/// Checks that this process may run on a core, counted from 0.
///
/// # Errors
/// [`Refused::Core`] with those that it may run on.
pub fn check_core(core: usize) -> Result<(), Refused> {
    let ids = core_affinity::get_core_ids().unwrap_or_default();
    let cores: Vec<usize> = ids.into_iter().map(|id| id.id).collect();
    if cores.contains(&core) { Ok(()) } else { Err(Refused::Core { core, cores }) }
}

/// Keeps the thread on a core.
fn stay_on(core: usize) -> Result<(), Refused> {
    // Checked first: the system's set of cores has an end, beyond which it may not be asked.
    check_core(core)?;
    if core_affinity::set_for_current(core_affinity::CoreId { id: core }) {
        return Ok(());
    }
    let ids = core_affinity::get_core_ids().unwrap_or_default();
    Err(Refused::Core { core, cores: ids.into_iter().map(|id| id.id).collect() })
}

/// Cores as ranges: `core 0 to 7, 12`.
struct Listed<'a>(&'a [usize]);

impl fmt::Display for Listed<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0.is_empty() {
            return f.write_str("cores that the system does not name");
        }
        let runs = self.0.chunk_by(|one, next| one + 1 == *next);
        for (k, run) in runs.enumerate() {
            f.write_str(if k == 0 { "core " } else { ", " })?;
            match run {
                [first, .., last] => write!(f, "{first} to {last}")?,
                _ => write!(f, "{}", run[0])?,
            }
        }
        Ok(())
    }
}

#[cfg(unix)]
fn memory() -> Result<(), String> {
    use rustix::mm::{MlockAllFlags, mlockall};
    mlockall(MlockAllFlags::CURRENT | MlockAllFlags::FUTURE).map_err(|error| error.to_string())
}

#[cfg(not(unix))]
fn memory() -> Result<(), String> {
    Err("this system has no such call".to_owned())
}

#[cfg(unix)]
fn first(priority: u8) -> Result<(), String> {
    let value = ThreadPriorityValue::try_from(priority).map_err(|error| error.to_string())?;
    let policy = ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::Fifo);
    let wanted = ThreadPriority::Crossplatform(value);
    set_thread_priority_and_policy(thread_native_id(), wanted, policy).map_err(|e| e.to_string())
}

#[cfg(not(unix))]
fn first(_: u8) -> Result<(), String> {
    use thread_priority::ThreadPriority;
    thread_priority::set_current_thread_priority(ThreadPriority::Max).map_err(|e| e.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cores_that_there_are_not_are_refused_with_those_that_there_are() {
        for core in [1024, 4096, usize::MAX] {
            let realtime = Realtime { core: Some(core), ..Realtime::default() };
            let [Refused::Core { core: refused, cores }] = &realtime.ask()[..] else {
                panic!("{core} was granted")
            };
            assert_eq!(*refused, core);
            for core in cores {
                assert_eq!(check_core(*core), Ok(()));
            }
        }
        let error = |cores| Refused::Core { core: 9, cores }.to_string();
        assert!(error(vec![0, 1, 2, 5, 7, 8]).ends_with("may run on core 0 to 2, 5, 7 to 8"));
        assert!(error(vec![]).ends_with("cores that the system does not name"));
    }
}
