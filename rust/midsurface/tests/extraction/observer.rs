//! An observer that remembers what it was told, and cancels when it is told to.

use std::thread::ThreadId;
use std::time::{Duration, Instant};

use midsurface::Observer;

/// One call of `progress`.
#[derive(Debug, Clone, PartialEq)]
pub struct Call {
    pub fraction: f64,
    pub stage: String,
    pub thread: ThreadId,
    pub after: Duration,
}

/// Remembers all calls and cancels at the one with index `cancel_at`.
#[derive(Debug)]
pub struct Recorder {
    pub calls: Vec<Call>,
    pub warnings: Vec<String>,
    pub cancel_at: usize,
    start: Instant,
}

impl Recorder {
    pub fn new(cancel_at: usize) -> Self {
        let start = Instant::now();
        Self {
            calls: Vec::new(),
            warnings: Vec::new(),
            cancel_at,
            start,
        }
    }
}

impl Observer for Recorder {
    fn progress(&mut self, fraction: f64, stage: &str) -> bool {
        self.calls.push(Call {
            fraction,
            stage: stage.to_owned(),
            thread: std::thread::current().id(),
            after: self.start.elapsed(),
        });
        self.calls.len() != self.cancel_at + 1
    }

    fn warning(&mut self, message: &str) {
        self.warnings.push(message.to_owned());
    }
}
