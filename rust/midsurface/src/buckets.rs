//! Items sorted into buckets by a number, without comparing them (counting sort).

use std::ops::Range;

use crate::error::{reserved, Result};

/// The items of bucket b are `list[start[b] .. start[b + 1]]`, in the order they came in.
pub(crate) struct Buckets<T> {
    start: Vec<u32>,
    list: Vec<T>,
}

impl<T: Copy + Default> Buckets<T> {
    /// Sorts items, each given with its bucket, into `count` buckets. `items` is called twice and
    /// has to give the same ones.
    pub fn new<I: Iterator<Item = (u32, T)>>(count: usize, items: impl Fn() -> I) -> Self {
        let mut start = vec![0u32; count + 2];
        for (bucket, _) in items() {
            start[bucket as usize + 2] += 1;
        }
        for b in 1..start.len() {
            start[b] += start[b - 1];
        }
        // Filling moves the start of a bucket, kept one place on, to its end.
        let mut list = vec![T::default(); start[count + 1] as usize];
        for (bucket, item) in items() {
            let slot = &mut start[bucket as usize + 1];
            list[*slot as usize] = item;
            *slot += 1;
        }
        start.pop();
        Self { start, list }
    }

    /// Buckets that `add` fills one after the other, given the list to append to, with `most` items
    /// in all.
    pub fn fill(
        count: usize,
        most: usize,
        mut add: impl FnMut(usize, &mut Vec<T>),
    ) -> Result<Self> {
        let mut start = reserved(count + 1)?;
        let mut list = reserved(most)?;
        start.push(0);
        for bucket in 0..count {
            add(bucket, &mut list);
            start.push(list.len() as u32);
        }
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
