//! The processor's widest vectors, chosen at run time.
//!
//! A build for every x86-64 processor works on four numbers at once where most could do eight.
//! What is inlined here is compiled for both. The results are the same bit for bit, since neither
//! joins or reorders operations.

/// Runs `work` with the widest vectors there are. Only what is inlined into `work` profits, so that
/// it should be a closure marked `#[inline(always)]` that calls functions marked so.
#[inline(always)]
pub(crate) fn with_widest_vectors<R>(work: impl FnOnce() -> R) -> R {
    pulp::Arch::new().dispatch(work)
}
