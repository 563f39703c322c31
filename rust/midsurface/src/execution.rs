//! Threads, progress and cancelling.
//!
//! The calling thread hands batches of work to a pool of the library's own and talks to the
//! observer between them, so that a host's callback is never called from a worker.

use std::sync::Arc;

use rayon::prelude::*;
use rayon::ThreadPool;

use crate::error::{reserved, Error, Result};
#[cfg(feature = "inject-panics")]
use crate::injected_panics::visit;
use crate::processes::exchange::{numbers, text, Team};

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

/// An observer that keeps warnings until the processes of a run are done.
pub(crate) struct Collected<'a> {
    observer: &'a mut dyn Observer,
    warnings: Vec<String>,
}

impl<'a> Collected<'a> {
    pub fn new(observer: &'a mut dyn Observer) -> Self {
        Self {
            observer,
            warnings: Vec::new(),
        }
    }

    /// Hands the warnings of all processes to the first one, each once.
    pub fn gather(&mut self, team: &mut Team) -> Result<()> {
        let own = std::mem::take(&mut self.warnings).join("\n");
        for of_process in team.gather(numbers(&own))? {
            for line in text(&of_process).lines() {
                // Those that work on the same component may say the same.
                if !self.warnings.iter().any(|known| known == line) {
                    self.warnings.push(line.to_owned());
                }
            }
        }
        Ok(())
    }

    /// Passes on what was kept.
    pub fn pass_on(self) {
        for warning in &self.warnings {
            self.observer.warning(warning);
        }
    }
}

impl Observer for Collected<'_> {
    fn progress(&mut self, fraction: f64, stage: &str) -> bool {
        self.observer.progress(fraction, stage)
    }
    fn warning(&mut self, message: &str) {
        self.warnings.push(message.to_owned());
    }
}

/// Where the tests of panics step in.
#[cfg(not(feature = "inject-panics"))]
fn visit(_place: (&'static str, usize)) {}

/// How long a batch should take, seconds: short enough to report and to cancel between them.
const BATCH_SECONDS: f64 = 0.05;

/// The most items in a batch.
const MOST_ITEMS: usize = 4096;

/// A pool and an observer for one run.
pub(crate) struct Execution<'a> {
    pool: Arc<ThreadPool>,
    observer: &'a mut dyn Observer,
    /// The share of the run's progress that stages share out, and the present stage's of that.
    span: [f64; 2],
    stage: &'static str,
    from: f64,
    to: f64,
    passes: usize,
    passes_done: usize,
}

impl<'a> Execution<'a> {
    /// Starts `threads` workers (0: one a core).
    pub fn new(threads: usize, observer: &'a mut dyn Observer) -> Result<Self> {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads.min(1024))
            .thread_name(|i| format!("midsurface-{i}"))
            .build()
            .map_err(|error| Error::Threads(error.to_string()))?;
        Ok(Self::on(&Arc::new(pool), observer))
    }

    /// Work of the same pool that another observer is told of.
    pub fn on(pool: &Arc<ThreadPool>, observer: &'a mut dyn Observer) -> Self {
        Self {
            pool: Arc::clone(pool),
            observer,
            span: [0.0, 1.0],
            stage: "",
            from: 0.0,
            to: 0.0,
            passes: 1,
            passes_done: 0,
        }
    }

    pub fn pool(&self) -> Arc<ThreadPool> {
        Arc::clone(&self.pool)
    }

    /// Lets the stages that follow share out the run's progress between `from` and `to`.
    pub fn within(&mut self, from: f64, to: f64) {
        self.span = [from, to];
    }

    /// The present span of the run's progress.
    pub fn span(&self) -> [f64; 2] {
        self.span
    }

    /// Announces the next stage, which takes the progress from `from` to `to`, counted within the
    /// present span, in so many passes over the data.
    pub fn stage(&mut self, stage: &'static str, from: f64, to: f64, passes: usize) -> Result<()> {
        (self.stage, self.from, self.to) = (stage, from, to);
        (self.passes, self.passes_done) = (passes, 0);
        self.report(0.0)
    }

    /// Corrects the number of passes of the present stage: so many are still to come. Once some are done
    /// they do not become more than announced: progress would go back.
    pub fn still(&mut self, passes: usize) {
        let all = self.passes_done + passes;
        let is_begun = self.passes_done > 0;
        self.passes = if is_begun { all.min(self.passes) } else { all };
    }

    /// Tells the observer how much of the stage's present pass is done.
    pub fn report(&mut self, share: f64) -> Result<()> {
        let passes = (self.passes_done as f64 + share) / self.passes as f64;
        let stages = self.from + (self.to - self.from) * passes.min(1.0);
        self.tell(stages, self.stage)
    }

    /// Tells the observer how much of the present span is done.
    pub fn tell(&mut self, done: f64, stage: &str) -> Result<()> {
        let fraction = self.span[0] + (self.span[1] - self.span[0]) * done;
        if self.observer.progress(fraction.clamp(0.0, 1.0), stage) {
            Ok(())
        } else {
            Err(Error::Cancelled)
        }
    }

    /// Reports that the whole run is done.
    pub fn finish(&mut self) -> Result<()> {
        self.within(1.0, 1.0);
        self.report(0.0)
    }

    /// Reports a pass that was made on the calling thread.
    pub fn pass_done(&mut self) -> Result<()> {
        visit(self.place());
        self.report(1.0)?;
        self.passes_done += 1;
        Ok(())
    }

    /// Passes a warning on.
    pub fn warning(&mut self, message: &str) {
        self.observer.warning(message);
    }

    /// Stage and pass.
    fn place(&self) -> (&'static str, usize) {
        (self.stage, self.passes_done)
    }

    /// Runs `work` in the pool: for passes that are over too soon to be reported.
    pub fn in_pool<R: Send>(&self, work: impl FnOnce() -> R + Send) -> R {
        self.pool.install(work)
    }

    /// Hands `f` of every item, in the items' order, to `keep` on the calling thread.
    pub fn stream<T: Sync, R: Send>(
        &mut self,
        items: &[T],
        f: impl Fn(&T) -> R + Sync,
        mut keep: impl FnMut(R) -> Result<()>,
    ) -> Result<()> {
        let place = self.place();
        let f = |item| {
            visit(place);
            f(item)
        };
        self.batches(items.len(), |pool, range| {
            let mut batch = reserved(range.len())?;
            pool.install(|| batch.par_extend(items[range].par_iter().map(&f)));
            batch.into_iter().try_for_each(&mut keep)
        })
    }

    /// `f` of 0 .. `count`, in order: for large buffers, which nobody has to fill with zeros first.
    pub fn collect<T: Send>(
        &mut self,
        count: usize,
        f: impl Fn(usize) -> T + Sync,
    ) -> Result<Vec<T>> {
        let mut items = reserved(count)?;
        let place = self.place();
        let f = |index| {
            visit(place);
            f(index)
        };
        self.batches(count, |pool, range| {
            pool.install(|| items.par_extend(range.into_par_iter().map(&f)));
            Ok(())
        })?;
        Ok(items)
    }

    /// Lets `f` fill `buffer` in pieces of `size`, each given its index.
    pub fn fill<T: Send>(
        &mut self,
        buffer: &mut [T],
        size: usize,
        f: impl Fn(usize, &mut [T]) + Sync,
    ) -> Result<()> {
        let pieces = buffer.len().div_ceil(size);
        let place = self.place();
        self.batches(pieces, |pool, range| {
            let end = (range.end * size).min(buffer.len());
            let batch = &mut buffer[range.start * size..end];
            pool.install(|| {
                batch
                    .par_chunks_mut(size)
                    .enumerate()
                    .for_each(|(i, piece)| {
                        visit(place);
                        f(range.start + i, piece)
                    })
            });
            Ok(())
        })
    }

    /// Runs `work` on consecutive ranges whose length adapts to [`BATCH_SECONDS`].
    fn batches(
        &mut self,
        count: usize,
        mut work: impl FnMut(&ThreadPool, std::ops::Range<usize>) -> Result<()>,
    ) -> Result<()> {
        let threads = self.pool.current_num_threads();
        let (mut start, mut size) = (0, threads * 4);
        while start < count {
            let end = (start + size).min(count);
            let clock = std::time::Instant::now();
            work(&self.pool, start..end)?;
            let seconds = clock.elapsed().as_secs_f64();
            if seconds < BATCH_SECONDS / 2.0 {
                // Cheap items may be followed by costly ones.
                let growth = if seconds < BATCH_SECONDS / 16.0 { 8 } else { 2 };
                size = (growth * size).min(MOST_ITEMS);
            } else if seconds > BATCH_SECONDS {
                size = (size / 2).max(threads);
            }
            start = end;
            self.report(end as f64 / count as f64)?;
        }
        self.passes_done += 1;
        Ok(())
    }
}
