//! What a thread can ask the system for, so that nothing else comes between its cycles.

#[cfg(unix)]
use thread_priority::{
    RealtimeThreadSchedulePolicy, ThreadPriority, ThreadPriorityValue, ThreadSchedulePolicy,
    set_thread_priority_and_policy, thread_native_id,
};

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
    #[error("not kept on core {0}: there is none, or it is not this process's")]
    Core(usize),
    /// The memory.
    #[error("memory is not locked ({0}): start as root, or allow it with `ulimit -l`")]
    Memory(String),
}

impl Realtime {
    /// Asks for it, for the thread that calls. What was refused is said; the rest holds.
    pub fn ask(&self) -> Vec<Refused> {
        let mut refused = Vec::new();
        if let Some(core) = self.core
            && !core_affinity::set_for_current(core_affinity::CoreId { id: core })
        {
            refused.push(Refused::Core(core));
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
