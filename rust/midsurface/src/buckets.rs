//! Items sorted into buckets by a number, without comparing them (counting sort).

use std::ops::Range;

use crate::error::{collected, extend, filled, reserved, zeros, Result};
use crate::execution::Execution;

/// Buckets handed to a worker at a time.
const PIECE: usize = 1024;
/// Items that a bucket seldom has more of, on average over a piece.
const MOSTLY: usize = 8;
/// Passes over the buckets that [`Buckets::fill`] makes, for its progress.
pub(crate) const PASSES: usize = 1;

/// The items of bucket b are `list[start[b] .. start[b + 1]]`, in the order they came in.
pub(crate) struct Buckets<T> {
    start: Vec<u32>,
    list: Vec<T>,
}

impl<T: Copy + Default> Buckets<T> {
    /// Sorts items, each given with its bucket, into `count` buckets. `items` is called twice and
    /// has to give the same ones.
    pub fn new<I: Iterator<Item = (u32, T)>>(count: usize, items: impl Fn() -> I) -> Result<Self> {
        let mut start: Vec<u32> = zeros(count + 2)?;
        items().for_each(|(bucket, _)| start[bucket as usize + 2] += 1);
        for b in 1..start.len() {
            start[b] += start[b - 1];
        }
        // Filling moves the start of a bucket, kept one place on, to its end.
        let mut list = filled(T::default(), start[count + 1] as usize)?;
        items().for_each(|(bucket, item)| {
            let slot = &mut start[bucket as usize + 1];
            list[*slot as usize] = item;
            *slot += 1;
        });
        start.pop();
        Ok(Self { start, list })
    }

    /// Buckets that `add` fills, in any order, given the list to append to, with `most` items in all.
    pub fn fill(
        count: usize,
        most: usize,
        add: impl Fn(usize, &mut Vec<T>) + Sync,
        execution: &mut Execution,
    ) -> Result<Self>
    where
        T: Send,
    {
        let mut start = reserved(count + 1)?;
        let mut list = reserved(most)?;
        start.push(0);
        let pieces = collected((0..count).step_by(PIECE))?;
        execution.stream(
            &pieces,
            |&first| {
                let (mut ends, mut items) = (reserved(PIECE)?, reserved(MOSTLY * PIECE)?);
                for bucket in first..(first + PIECE).min(count) {
                    add(bucket, &mut items);
                    ends.push(items.len() as u32);
                }
                Ok((ends, items))
            },
            |piece: Result<(Vec<u32>, Vec<T>)>| {
                let (ends, items) = piece?;
                let before = list.len() as u32;
                start.extend(ends.into_iter().map(|end| before + end));
                extend(&mut list, items)
            },
        )?;
        Ok(Self { start, list })
    }

    /// Number of buckets.
    pub fn count(&self) -> usize {
        self.start.len() - 1
    }

    /// Where a bucket's items are in [`Self::all`].
    pub fn range(&self, bucket: usize) -> Range<usize> {
        self.start[bucket] as usize..self.start[bucket + 1] as usize
    }

    /// The items of a bucket.
    pub fn of(&self, bucket: usize) -> &[T] {
        &self.list[self.range(bucket)]
    }

    /// The items of a bucket.
    pub fn of_mut(&mut self, bucket: usize) -> &mut [T] {
        let range = self.range(bucket);
        &mut self.list[range]
    }

    /// All items, bucket by bucket.
    pub fn all(&self) -> &[T] {
        &self.list
    }
}
