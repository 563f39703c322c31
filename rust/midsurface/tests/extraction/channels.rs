//! Threads that talk to each other as processes do.

use std::sync::mpsc::{channel, Receiver, Sender};

use super::Exchange;

/// Threads in place of processes. A send does not wait for its receiver.
pub struct Channels {
    pub process: usize,
    to: Vec<Sender<Vec<i64>>>,
    from: Vec<Receiver<Vec<i64>>>,
}

impl Exchange for Channels {
    fn processes(&self) -> usize {
        self.to.len()
    }
    fn process(&self) -> usize {
        self.process
    }
    fn send(&mut self, to: usize, numbers: &[i64]) -> bool {
        assert_ne!(to, self.process);
        self.to[to].send(numbers.to_vec()).is_ok()
    }
    fn receive(&mut self, from: usize, numbers: &mut [i64]) -> bool {
        let Ok(received) = self.from[from].recv() else {
            return false;
        };
        assert_eq!(received.len(), numbers.len());
        numbers.copy_from_slice(&received);
        true
    }
}

pub fn connect(processes: usize) -> Vec<Channels> {
    let mut ends: Vec<Channels> = (0..processes)
        .map(|process| Channels {
            process,
            to: Vec::new(),
            from: Vec::new(),
        })
        .collect();
    for from in 0..processes {
        for to in 0..processes {
            let (sender, receiver) = channel();
            ends[from].to.push(sender);
            ends[to].from.push(receiver);
        }
    }
    ends
}
