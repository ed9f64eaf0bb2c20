//! A process to one that Windows holds in a job: its memory, no other process, its end with its reader's.
//!
//! `win32job` 2 can set none of these limits; 1 has their fields open. A job does not limit processor time
//! there, and keeps no file from the process.

use std::os::windows::io::AsRawHandle;
use std::process::Child;
use std::sync::OnceLock;
use win32job::{ExtendedLimitInfo, Job};

/// Names of Windows for what a job limits (`winnt.h`).
const ACTIVE_PROCESS: u32 = 0x8;
const JOB_MEMORY: u32 = 0x200;
/// No window with an error waits for a person.
const DIE_ON_UNHANDLED_EXCEPTION: u32 = 0x400;

/// Holds this process, from the first call on for good, to so much memory, and to starting no other.
pub(super) fn hold_this_process(memory_bytes: u64) {
    static OWN: OnceLock<Option<Job>> = OnceLock::new();
    let mut limits = ExtendedLimitInfo::new();
    let basic = &mut limits.0.BasicLimitInformation;
    basic.LimitFlags = ACTIVE_PROCESS | JOB_MEMORY | DIE_ON_UNHANDLED_EXCEPTION;
    basic.ActiveProcessLimit = 1;
    limits.0.JobMemoryLimit = usize::try_from(memory_bytes).unwrap_or(usize::MAX);
    let entered = || Job::create().ok().filter(|job| job.assign_current_process().is_ok());
    // Without a job the reader's own patience is left.
    if let Some(job) = OWN.get_or_init(entered) {
        let _ = job.set_extended_limit_info(&mut limits);
    }
}

/// A job that ends `child` when it is dropped, or when this process ends in whatever way.
pub(super) fn that_ends(child: &Child) -> Option<Job> {
    let mut limits = ExtendedLimitInfo::new();
    limits.limit_kill_on_job_close();
    let job = Job::create_with_limit_info(&mut limits).ok()?;
    job.assign_process(child.as_raw_handle().cast()).is_ok().then_some(job)
}
