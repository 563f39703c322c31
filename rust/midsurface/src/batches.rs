//! Batches of whole components, so that memory follows the largest batches and not the volume.
//!
//! Some batches are worked on side by side: what a stage of one cannot share out among the workers
//! leaves them to the other. Results are kept in the order of the batches, by the calling thread,
//! which alone talks to the observer.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{channel, Receiver, Sender};
use std::sync::Arc;

use rayon::ThreadPool;

use crate::error::{collected, push, Result};
use crate::execution::{Execution, Observer, Quiet};
use crate::fields::bricks::BRICK;
use crate::reading::components::Part;

/// Batches that are worked on at once.
const SIDE_BY_SIDE: usize = 2;
/// Cost of the parts of a batch; a larger component is a batch of its own.
const BATCH_COST: usize = 300_000;

/// What a worker tells the calling thread of a batch.
enum Message<R> {
    Progress(usize, f64, String),
    Done(usize, Result<R>, Vec<String>),
    /// There is no batch left to take, or the work on one panicked.
    Left,
}

/// The batches of a run, and which of them are taken.
struct Queue<'a> {
    parts: &'a [Part],
    batches: Vec<Range<usize>>,
    taken: AtomicUsize,
    is_cancelled: AtomicBool,
}

impl<'a> Queue<'a> {
    /// Takes batches until none is left, or the run is cancelled.
    fn work<R>(
        &self,
        pool: &Arc<ThreadPool>,
        sender: &Sender<Message<R>>,
        work: &impl Fn(&'a [Part], &mut Execution) -> Result<R>,
    ) {
        // Sends its message and cancels in a panic, too.
        let _leaving = Leaving(self, sender);
        while !self.is_cancelled.load(Ordering::Relaxed) {
            let batch = self.taken.fetch_add(1, Ordering::Relaxed);
            if batch >= self.batches.len() {
                return;
            }
            let mut teller = Teller {
                batch,
                sender,
                is_cancelled: &self.is_cancelled,
                kept: Quiet::default(),
            };
            let mut execution = Execution::on(pool, &mut teller);
            let result = work(self.parts(batch), &mut execution);
            let _ = sender.send(Message::Done(batch, result, teller.kept.warnings));
        }
    }

    fn parts(&self, batch: usize) -> &'a [Part] {
        &self.parts[self.batches[batch].clone()]
    }
}

/// Tells that a worker takes no more batches.
struct Leaving<'a, R>(&'a Queue<'a>, &'a Sender<Message<R>>);

impl<R> Drop for Leaving<'_, R> {
    fn drop(&mut self) {
        if std::thread::panicking() {
            self.0.is_cancelled.store(true, Ordering::Relaxed);
        }
        let _ = self.1.send(Message::Left);
    }
}

/// The observer of a batch: passes progress on to the calling thread and keeps the warnings.
struct Teller<'a, R> {
    batch: usize,
    sender: &'a Sender<Message<R>>,
    is_cancelled: &'a AtomicBool,
    kept: Quiet,
}

impl<R> Observer for Teller<'_, R> {
    fn progress(&mut self, fraction: f64, stage: &str) -> bool {
        let message = Message::Progress(self.batch, fraction, stage.to_owned());
        self.sender.send(message).is_ok() && !self.is_cancelled.load(Ordering::Relaxed)
    }
    fn warning(&mut self, message: &str) {
        self.kept.warning(message);
    }
}

/// Hands what `work` makes of the parts, which are ordered by component, batch by batch, to `keep`.
/// All takes this `span` of the progress.
pub(crate) fn for_each_batch<'a, R: Send>(
    all_parts: &'a [Part],
    execution: &mut Execution,
    span: [f64; 2],
    work: impl Fn(&'a [Part], &mut Execution) -> Result<R> + Sync,
    keep: impl FnMut(&[Part], R) -> Result<()>,
) -> Result<()> {
    let queue = Queue {
        parts: all_parts,
        batches: batches(all_parts)?,
        taken: AtomicUsize::new(0),
        is_cancelled: AtomicBool::new(false),
    };
    let pool = execution.pool();
    let workers = SIDE_BY_SIDE.min(pool.current_num_threads());
    let (sender, receiver) = channel();
    execution.within(span[0], span[1]);
    pool.in_place_scope(|scope| {
        scope.spawn_broadcast(|_, worker| {
            if worker.index() < workers {
                queue.work(&pool, &sender, &work);
            }
        });
        receive(&queue, (&receiver, workers), execution, keep)
    })?;
    execution.within(span[1], 1.0);
    Ok(())
}

/// Passes on what the workers tell until all of them have left.
fn receive<R>(
    queue: &Queue,
    (receiver, mut workers): (&Receiver<Message<R>>, usize),
    execution: &mut Execution,
    mut keep: impl FnMut(&[Part], R) -> Result<()>,
) -> Result<()> {
    let mut progress = Progress::new(queue)?;
    let mut waiting = collected(queue.batches.iter().map(|_| None))?;
    let (mut kept, mut result) = (0, Ok(()));
    while workers > 0 {
        let outcome = match receiver.recv() {
            Err(_) | Ok(Message::Left) => {
                workers -= 1;
                continue;
            }
            // Nobody is asked or told anything after a failure.
            Ok(_) if result.is_err() => continue,
            Ok(Message::Progress(batch, fraction, stage)) => {
                execution.tell(progress.of_all(batch, fraction), &stage)
            }
            Ok(Message::Done(batch, found, warnings)) => {
                warnings.iter().for_each(|w| execution.warning(w));
                found.and_then(|found| {
                    waiting[batch] = Some(found);
                    while let Some(found) = waiting.get_mut(kept).and_then(Option::take) {
                        keep(queue.parts(kept), found)?;
                        kept += 1;
                    }
                    Ok(())
                })
            }
        };
        if outcome.is_err() {
            queue.is_cancelled.store(true, Ordering::Relaxed);
            result = outcome;
        }
    }
    result
}

/// How much of each batch is done, and of all.
struct Progress {
    /// What is done of each batch, and the batch's share of all voxels.
    of_batches: Vec<(f64, f64)>,
    done: f64,
}

impl Progress {
    fn new(queue: &Queue) -> Result<Self> {
        let voxels = |parts: &[Part]| parts.iter().map(Part::voxels).sum::<usize>() as f64;
        let all = voxels(queue.parts);
        let batches = 0..queue.batches.len();
        Ok(Self {
            of_batches: collected(batches.map(|batch| (0.0, voxels(queue.parts(batch)) / all)))?,
            done: 0.0,
        })
    }

    /// What is done of all, once so much of a batch is.
    fn of_all(&mut self, batch: usize, fraction: f64) -> f64 {
        let (done, share) = &mut self.of_batches[batch];
        self.done += (fraction - std::mem::replace(done, fraction)) * *share;
        self.done
    }
}

/// What working on a part takes, in voxels: its own, and the bricks that even a small one has.
fn cost_of(part: &Part) -> usize {
    2 * part.voxels() + 2 * BRICK
}

/// Cuts the parts into batches of whole components.
fn batches(parts: &[Part]) -> Result<Vec<Range<usize>>> {
    let mut batches = Vec::new();
    let (mut start, mut end, mut cost) = (0, 0, 0);
    for component in parts.chunk_by(|a, b| a.component == b.component) {
        let size: usize = component.iter().map(cost_of).sum();
        if cost > 0 && cost + size > BATCH_COST {
            push(&mut batches, start..end)?;
            (start, cost) = (end, 0);
        }
        end += component.len();
        cost += size;
    }
    if end > start {
        push(&mut batches, start..end)?;
    }
    Ok(batches)
}
