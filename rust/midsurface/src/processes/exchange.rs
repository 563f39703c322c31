//! Processes that work on one volume together, and how they agree on failure.
//!
//! The processes take the same steps in the same order. Between two steps everybody sends everybody
//! else a message, which may be empty. A process that fails sends its failure in place of its next
//! message; so all of them end at the same place, with an error, and nobody waits for ever.

use crate::error::{reserved, Error, Result};

/// How processes reach each other. Implemented by the host, for example on MPI. The functions are
/// called on the thread that started the run, never on a worker.
pub trait Exchange {
    /// Number of processes, at least 1.
    fn processes(&self) -> usize;
    /// Number of this process, from 0.
    fn process(&self) -> usize;
    /// Sends numbers to another process, and may wait until they are received. `false`: the
    /// connection is broken.
    fn send(&mut self, to: usize, numbers: &[i64]) -> bool;
    /// Receives as many numbers from another process as it sends, and waits for them. `false`: the
    /// connection is broken.
    fn receive(&mut self, from: usize, numbers: &mut [i64]) -> bool;
}

/// Tells the other processes that this one cannot take part in the run that they are about to
/// start, or that they have started, and why. They end with an error that holds the message.
pub fn abandon(exchange: &mut dyn Exchange, message: &str) {
    Team::new(exchange).tell_failure(FAILURE, message);
}

/// The process that decides what has to be decided in one place, and that talks to the user.
pub(crate) const FIRST: usize = 0;

/// The most numbers that are sent at once: a receiver that is refused the memory for a message
/// still has to take it.
const MOST_NUMBERS: usize = 1 << 12;

/// What precedes a message.
const MESSAGE: i64 = 0;
const FAILURE: i64 = 1;
const CANCELLED: i64 = 2;

/// What a process that works alone exchanges: nothing.
pub(crate) struct Alone;

impl Exchange for Alone {
    fn processes(&self) -> usize {
        1
    }
    fn process(&self) -> usize {
        FIRST
    }
    fn send(&mut self, _: usize, _: &[i64]) -> bool {
        false
    }
    fn receive(&mut self, _: usize, _: &mut [i64]) -> bool {
        false
    }
}

/// The processes as a team, seen from one of them.
pub(crate) struct Team<'a> {
    exchange: &'a mut dyn Exchange,
    /// Whether everybody knows how this run ended.
    is_over: bool,
}

impl<'a> Team<'a> {
    pub fn new(exchange: &'a mut dyn Exchange) -> Self {
        Self {
            exchange,
            is_over: false,
        }
    }

    pub fn processes(&self) -> usize {
        self.exchange.processes()
    }

    pub fn process(&self) -> usize {
        self.exchange.process()
    }

    pub fn is_first(&self) -> bool {
        self.process() == FIRST
    }

    /// Sends each process its message, and returns those of all processes in their order.
    pub fn swap(&mut self, messages: Vec<Vec<i64>>) -> Result<Vec<Vec<i64>>> {
        self.rounds(MESSAGE, messages)
    }

    /// Sends one message to the first process, which gets those of all; the others get nothing.
    pub fn gather(&mut self, message: Vec<i64>) -> Result<Vec<Vec<i64>>> {
        let mut messages = vec![Vec::new(); self.processes()];
        messages[FIRST] = message;
        let received = self.swap(messages)?;
        Ok(if self.is_first() {
            received
        } else {
            Vec::new()
        })
    }

    /// Sends one message to all processes, and returns those of all in their order.
    pub fn share(&mut self, message: &[i64]) -> Result<Vec<Vec<i64>>> {
        self.swap(vec![message.to_vec(); self.processes()])
    }

    /// Ends the run, well or not: all processes have to hear of it.
    pub fn close<T>(mut self, result: Result<T>) -> Result<T> {
        let nothing = vec![Vec::new(); self.processes()];
        match &result {
            Ok(_) => {
                let end = self.rounds(MESSAGE, nothing);
                self.is_over = true;
                end.and(result)
            }
            Err(error) => {
                let is_cancelled = *error == Error::Cancelled;
                let kind = if is_cancelled { CANCELLED } else { FAILURE };
                self.tell_failure(kind, &error.to_string());
                result
            }
        }
    }

    fn tell_failure(&mut self, kind: i64, message: &str) {
        if self.is_over {
            return;
        }
        self.is_over = true;
        let text = numbers(message);
        // What the others answer no longer matters.
        let _ = self.rounds(kind, vec![text; self.processes()]);
    }

    /// Everybody meets everybody once: in each round the processes make pairs, of which the one with
    /// the lower number sends first. However long a send waits, the first pair in the order of
    /// rounds that is not done can go on.
    fn rounds(&mut self, kind: i64, mut messages: Vec<Vec<i64>>) -> Result<Vec<Vec<i64>>> {
        let (count, own) = (self.processes(), self.process());
        messages.resize_with(count, Vec::new);
        let mut received = vec![Vec::new(); count];
        let mut failures = Vec::new();
        for round in 0..count {
            let partner = (round + count - own) % count;
            let message = std::mem::take(&mut messages[partner]);
            if partner == own {
                received[own] = message;
                continue;
            }
            let outcome = if own < partner {
                self.send(partner, kind, message)?;
                self.receive(partner)?
            } else {
                let outcome = self.receive(partner)?;
                self.send(partner, kind, message)?;
                outcome
            };
            match outcome {
                Ok(message) => received[partner] = message,
                Err(error) => failures.push(error),
            }
        }
        // Where only this process failed, to take a message, the others do not know of it yet.
        let is_told = |error: &Error| !matches!(error, Error::OutOfMemory(_));
        self.is_over |= failures.iter().any(is_told);
        failures.into_iter().next().map_or(Ok(received), Err)
    }

    fn send(&mut self, to: usize, kind: i64, message: Vec<i64>) -> Result<()> {
        let head = [kind, message.len() as i64];
        let mut sent = self.exchange.send(to, &head);
        for piece in message.chunks(MOST_NUMBERS) {
            sent = sent && self.exchange.send(to, piece);
        }
        self.check(sent)
    }

    /// A message, or the failure of its sender or of this process to take it.
    fn receive(&mut self, from: usize) -> Result<Result<Vec<i64>>> {
        let mut head = [0; 2];
        let is_there = self.exchange.receive(from, &mut head);
        self.check(is_there)?;
        let [kind, length] = head;
        let length = length as usize;
        let mut message = reserved(length);
        let mut unwanted = [0; MOST_NUMBERS];
        let mut done = 0;
        while done < length {
            let size = (length - done).min(MOST_NUMBERS);
            let is_there = match &mut message {
                Ok(message) => {
                    message.resize(done + size, 0);
                    self.exchange.receive(from, &mut message[done..])
                }
                Err(_) => self.exchange.receive(from, &mut unwanted[..size]),
            };
            self.check(is_there)?;
            done += size;
        }
        Ok(match kind {
            MESSAGE => message,
            CANCELLED => Err(Error::Cancelled),
            _ => Err(Error::Elsewhere {
                process: from,
                message: text(&message.unwrap_or_default()),
            }),
        })
    }

    fn check(&mut self, is_there: bool) -> Result<()> {
        if is_there {
            return Ok(());
        }
        self.is_over = true;
        Err(Error::Connection)
    }
}

/// A panic must not leave the others waiting.
impl Drop for Team<'_> {
    fn drop(&mut self) {
        if std::thread::panicking() {
            self.tell_failure(FAILURE, "internal error");
        }
    }
}

/// Takes so many numbers from the beginning of a message.
pub(crate) fn taken<const N: usize>(message: &mut &[i64]) -> Result<[i64; N]> {
    let (numbers, rest) = message.split_first_chunk().ok_or(Error::Pieces)?;
    *message = rest;
    Ok(*numbers)
}

/// A text as numbers, a byte each.
pub(crate) fn numbers(text: &str) -> Vec<i64> {
    text.bytes().map(i64::from).collect()
}

/// What [`numbers`] were made of.
pub(crate) fn text(numbers: &[i64]) -> String {
    let bytes: Vec<u8> = numbers.iter().map(|&byte| byte as u8).collect();
    String::from_utf8_lossy(&bytes).into_owned()
}
