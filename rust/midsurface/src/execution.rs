//! Threads, progress and cancelling.
//!
//! The calling thread hands batches of work to a pool of the library's own and talks to the
//! observer between them, so that a host's callback is never called from a worker.

use rayon::prelude::*;
use rayon::ThreadPool;

use crate::error::{Error, Result};

/// What the caller of a run is told. Called on the calling thread only.
pub trait Observer {
    /// `fraction` of the whole run (0 to 1) is done, `stage` is under way; `false` cancels the run.
    fn progress(&mut self, fraction: f64, stage: &str) -> bool;
    /// Something the user should know, although the run goes on.
    fn warning(&mut self, message: &str);
}

/// An observer that never cancels and keeps the warnings.
#[derive(Debug, Default)]
pub struct Quiet {
    /// All warnings, in order.
    pub warnings: Vec<String>,
}

impl Observer for Quiet {
    fn progress(&mut self, _fraction: f64, _stage: &str) -> bool {
        true
    }
    fn warning(&mut self, message: &str) {
        self.warnings.push(message.to_owned());
    }
}
