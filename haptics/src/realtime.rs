//! Real-time scheduling of a thread: priority, core and memory locking.

#[cfg(unix)]
use thread_priority::{
    RealtimeThreadSchedulePolicy, ThreadPriority, ThreadPriorityValue, ThreadSchedulePolicy,
    set_thread_priority_and_policy, thread_native_id,
};

use std::fmt;

/// Real-time properties requested for a thread.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Realtime {
    /// First-in-first-out real-time priority, from 1 to 99, ahead of all threads without one; `None` for
    /// no change.
    pub priority: Option<u8>,
    /// The only core to run on, counted from 0; `None` for any.
    pub core: Option<usize>,
    /// `true` to lock all memory of the process.
    pub locked: bool,
}

/// A request that the system refused. The loop runs without it.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum RealtimeError {
    /// The priority was refused.
    #[error("no real-time priority ({0}): start as root, or allow it with `ulimit -r`")]
    Priority(String),
    /// The core was refused.
    #[error("not kept on core {core}: this process may run on {}", CoreList(.cores))]
    Core {
        /// The requested core.
        core: usize,
        /// The cores available to this process, in ascending order.
        cores: Vec<usize>,
    },
    /// Memory locking was refused.
    #[error("memory is not locked ({0}): start as root, or allow it with `ulimit -l`")]
    Memory(String),
}

impl Realtime {
    /// Applies the requests to the calling thread. Returns those that were refused; the others take
    /// effect.
    pub fn apply(&self) -> Vec<RealtimeError> {
        let mut errors = Vec::new();
        if let Some(core) = self.core
            && let Err(error) = pin_to_core(core)
        {
            errors.push(error);
        }
        if self.locked
            && let Err(error) = lock_memory()
        {
            errors.push(RealtimeError::Memory(error));
        }
        if let Some(priority) = self.priority
            && let Err(error) = set_priority(priority)
        {
            errors.push(RealtimeError::Priority(error));
        }
        errors
    }
}

/// Checks that this process may run on a core, counted from 0.
///
/// # Errors
/// Returns [`RealtimeError::Core`] with the available cores if it may not.
pub fn check_core(core: usize) -> Result<(), RealtimeError> {
    let ids = core_affinity::get_core_ids().unwrap_or_default();
    let cores: Vec<usize> = ids.into_iter().map(|id| id.id).collect();
    if cores.contains(&core) { Ok(()) } else { Err(RealtimeError::Core { core, cores }) }
}

/// Binds the calling thread to a core.
fn pin_to_core(core: usize) -> Result<(), RealtimeError> {
    // Check first: the system's core set has a fixed size, beyond which no core may be requested.
    check_core(core)?;
    if core_affinity::set_for_current(core_affinity::CoreId { id: core }) {
        return Ok(());
    }
    let ids = core_affinity::get_core_ids().unwrap_or_default();
    Err(RealtimeError::Core { core, cores: ids.into_iter().map(|id| id.id).collect() })
}

/// A list of cores, displayed as ranges: `core 0 to 7, 12`.
struct CoreList<'a>(&'a [usize]);

impl fmt::Display for CoreList<'_> {
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
fn lock_memory() -> Result<(), String> {
    use rustix::mm::{MlockAllFlags, mlockall};
    mlockall(MlockAllFlags::CURRENT | MlockAllFlags::FUTURE).map_err(|error| error.to_string())
}

#[cfg(not(unix))]
fn lock_memory() -> Result<(), String> {
    Err("this system has no such call".to_owned())
}

#[cfg(unix)]
fn set_priority(priority: u8) -> Result<(), String> {
    let value = ThreadPriorityValue::try_from(priority).map_err(|error| error.to_string())?;
    let policy = ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::Fifo);
    let priority_value = ThreadPriority::Crossplatform(value);
    set_thread_priority_and_policy(thread_native_id(), priority_value, policy)
        .map_err(|e| e.to_string())
}

#[cfg(not(unix))]
fn set_priority(_: u8) -> Result<(), String> {
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
            let [RealtimeError::Core { core: refused, cores }] = &realtime.apply()[..] else {
                panic!("{core} was granted")
            };
            assert_eq!(*refused, core);
            for core in cores {
                assert_eq!(check_core(*core), Ok(()));
            }
        }
        let error = |cores| RealtimeError::Core { core: 9, cores }.to_string();
        assert!(error(vec![0, 1, 2, 5, 7, 8]).ends_with("may run on core 0 to 2, 5, 7 to 8"));
        assert!(error(vec![]).ends_with("cores that the system does not name"));
    }
}
