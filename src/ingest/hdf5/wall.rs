//! A process to one that can do nothing but take one HDF5 file apart: what it may reach, hold and spend.
//!
//! The C library reads bytes that anybody may have made, and mistakes in it are found every year
//! (docs/dependencies.md).

use std::path::Path;

/// Memory for the program, the library and what it notes of a file, bytes. An empty file takes 60 MB of
/// addresses, 10 000 datasets 20 more.
const LEAST_MEMORY_BYTES: u64 = 192 << 20;
/// Processor time that opening and describing a file may take, s: 10 000 datasets with attributes take less
/// than half of one.
const LEAST_SECONDS: u64 = 2;
/// What the library unpacks and hands over within a second on the slowest machine in use: a tenth of what was
/// measured.
const BYTES_PER_S: u64 = 20_000_000;

/// What the process has been granted.
pub(super) struct Wall {
    asked_bytes: u64,
    /// Whether the system keeps it from all other files and calls.
    pub is_whole: bool,
}

impl Wall {
    /// Closes this process in: from now on it can read `recording`, what it has open, and nothing else; for
    /// good.
    pub(super) fn around(recording: &Path) -> Self {
        let mut wall = Self { asked_bytes: 0, is_whole: false };
        wall.limit(0);
        wall.is_whole = reach::nothing_but(recording);
        wall
    }

    /// Grants the time for `bytes` of values more, and memory for `held_bytes` at a time.
    pub(super) fn grant(&mut self, bytes: u64, held_bytes: u64) {
        self.asked_bytes = self.asked_bytes.saturating_add(bytes);
        self.limit(held_bytes);
    }

    fn limit(&self, held_bytes: u64) {
        // The library has a chunk packed and unpacked, the reader what comes out of it.
        let memory_bytes = held_bytes.saturating_mul(4).saturating_add(LEAST_MEMORY_BYTES);
        hold(memory_bytes, LEAST_SECONDS.saturating_add(self.asked_bytes / BYTES_PER_S));
    }
}

/// Holds this process to so much memory and processor time; a system that knows no such limit has the
/// reader's own patience left.
#[cfg(unix)]
fn hold(memory_bytes: u64, seconds: u64) {
    use rustix::process::{Resource, Rlimit, getrlimit, setrlimit};
    for (resource, limit) in [(Resource::As, memory_bytes), (Resource::Cpu, seconds), (Resource::Core, 0)] {
        let maximum = getrlimit(resource).maximum;
        let current = maximum.map_or(limit, |maximum| limit.min(maximum));
        let _ = setrlimit(resource, Rlimit { current: Some(current), maximum });
    }
}

#[cfg(windows)]
fn hold(memory_bytes: u64, _: u64) {
    super::job::hold_this_process(memory_bytes);
}

#[cfg(target_os = "linux")]
mod reach {
    use landlock::{
        ABI, Access, AccessFs, AccessNet, PathBeneath, PathFd, Ruleset, RulesetAttr, RulesetCreatedAttr,
        RulesetError, RulesetStatus, Scope,
    };
    use seccompiler::{
        BpfProgram, Error, SeccompAction, SeccompCmpArgLen, SeccompCmpOp, SeccompCondition, SeccompFilter,
        SeccompRule,
    };
    use std::collections::BTreeMap;
    use std::path::Path;

    /// Calls to the system that the library, its allocator, the pipes and the end of a process need.
    const CALLS: [i64; 27] = [
        libc::SYS_close,
        libc::SYS_read,
        libc::SYS_readv,
        libc::SYS_pread64,
        libc::SYS_write,
        libc::SYS_writev,
        libc::SYS_lseek,
        libc::SYS_fstat,
        libc::SYS_newfstatat,
        libc::SYS_statx,
        libc::SYS_readlinkat,
        libc::SYS_getcwd,
        libc::SYS_flock,
        libc::SYS_brk,
        libc::SYS_munmap,
        libc::SYS_mremap,
        libc::SYS_madvise,
        libc::SYS_clock_gettime,
        libc::SYS_gettimeofday,
        libc::SYS_futex,
        libc::SYS_getrandom,
        libc::SYS_sigaltstack,
        libc::SYS_rt_sigprocmask,
        libc::SYS_rt_sigreturn,
        libc::SYS_getpid,
        libc::SYS_exit,
        libc::SYS_exit_group,
    ];
    /// Those of older C libraries, which the architectures after x86-64 never had.
    #[cfg(target_arch = "x86_64")]
    const OLD_CALLS: [i64; 2] = [libc::SYS_stat, libc::SYS_lstat];
    #[cfg(not(target_arch = "x86_64"))]
    const OLD_CALLS: [i64; 0] = [];

    /// Whether both walls stand: a kernel that knows one of them only, or none, leaves the other, or the
    /// limits alone.
    pub(super) fn nothing_but(recording: &Path) -> bool {
        let are_files_shut = files(recording).is_ok_and(|ruleset| ruleset != RulesetStatus::NotEnforced);
        let are_calls_shut = calls().is_ok_and(|program| seccompiler::apply_filter(&program).is_ok());
        are_files_shut && are_calls_shut
    }

    /// No file but the recording, no network, no other process.
    fn files(recording: &Path) -> Result<RulesetStatus, RulesetError> {
        let newest = ABI::V6;
        let rules = Ruleset::default()
            .handle_access(AccessFs::from_all(newest))?
            .handle_access(AccessNet::from_all(newest))?
            .scope(Scope::from_all(newest))?
            .create()?;
        let rules = match PathFd::new(recording) {
            Ok(opened) => rules.add_rule(PathBeneath::new(opened, AccessFs::ReadFile))?,
            Err(_) => rules,
        };
        rules.restrict_self().map(|restricted| restricted.ruleset)
    }

    /// No call but these; every other fails as if it were not permitted.
    fn calls() -> Result<BpfProgram, Error> {
        let where_bits = |argument, mask: u64, equal: u64| {
            let is = SeccompCmpOp::MaskedEq(mask);
            let condition = SeccompCondition::new(argument, SeccompCmpArgLen::Dword, is, equal)?;
            Ok::<_, Error>(vec![SeccompRule::new(vec![condition])?])
        };
        let [own, any_bit] = [u64::from(std::process::id()), u64::from(u32::MAX)];
        let bits = |flag: i32| u64::from(flag.unsigned_abs());
        let mut rules: BTreeMap<i64, Vec<SeccompRule>> =
            CALLS.iter().chain(&OLD_CALLS).map(|call| (*call, Vec::new())).collect();
        for call in [libc::SYS_mmap, libc::SYS_mprotect] {
            rules.insert(call, where_bits(2, bits(libc::PROT_EXEC), 0)?);
        }
        rules.insert(libc::SYS_openat, where_bits(2, bits(libc::O_ACCMODE), bits(libc::O_RDONLY))?);
        // Its own limits; the signal by which it aborts.
        rules.insert(libc::SYS_prlimit64, where_bits(0, any_bit, 0)?);
        rules.insert(libc::SYS_tgkill, where_bits(0, any_bit, own)?);
        rules.insert(libc::SYS_fcntl, where_bits(1, any_bit, bits(libc::F_GETFL))?);
        let not_permitted = SeccompAction::Errno(libc::EPERM.unsigned_abs());
        let architecture = std::env::consts::ARCH.try_into()?;
        Ok(SeccompFilter::new(rules, not_permitted, SeccompAction::Allow, architecture)?.try_into()?)
    }
}

#[cfg(not(target_os = "linux"))]
mod reach {
    /// Such a system gives no wall that a process builds around itself without rights: docs/dependencies.md.
    pub(super) fn nothing_but(_: &std::path::Path) -> bool {
        false
    }
}
