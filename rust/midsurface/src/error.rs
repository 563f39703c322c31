//! What can go wrong, each with a message a user can act on; and buffers whose size follows the data,
//! for which a refusal is one of these errors and not the end of the program.

use bytemuck::{allocation::try_zeroed_vec, Zeroable};

/// Why a call has no result.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    /// The buffer is not as long as the dimensions say.
    #[error(
        "the volume is said to have {dimensions:?} voxels, but its array holds {length} values"
    )]
    BufferLength {
        /// Claimed number of voxels along x, y, z.
        dimensions: [usize; 3],
        /// Number of scalars in the buffer.
        length: usize,
    },
    /// The number of voxels does not fit into an index.
    #[error("the volume's dimensions {0:?} are too large to be indexed")]
    Dimensions([usize; 3]),
    /// Spacing must be a positive, finite length.
    #[error("the spacing {0:?} is not usable: every axis needs a positive, finite spacing (set it in the image's properties)")]
    Spacing([f64; 3]),
    /// Origin or direction hold values that are no numbers, or the direction is singular.
    #[error("the image's {0} is not usable: it must be finite, and a direction matrix must not be singular")]
    Placement(&'static str),
    /// Floating point scalars that are not whole numbers.
    #[error("the array holds {value} at voxel {voxel:?}, but labels are whole numbers: choose a segmentation; for a probability map, use a threshold")]
    NotALabel {
        /// The offending value, printed.
        value: String,
        /// Its index along x, y, z, counted from the first voxel.
        voxel: [usize; 3],
    },
    /// A whole number that is too large to be a label.
    #[error("the array holds {value} at voxel {voxel:?}, which is too large for a label: labels go up to 2^63 - 1, in floating point up to 2^53; give the structure a smaller number")]
    LabelTooLarge {
        /// The offending value, printed.
        value: String,
        /// Its index along x, y, z, counted from the first voxel.
        voxel: [usize; 3],
    },
    /// So many labels that it cannot be a segmentation.
    #[error("the array holds more than {limit} distinct values: it looks like a raw tomogram, not a segmentation")]
    TooManyLabels {
        /// The largest number of labels that is accepted.
        limit: usize,
    },
    /// So many runs that it cannot be a segmentation of thin slabs.
    #[error("the array changes its value almost from voxel to voxel ({labels} distinct values): it looks like a raw tomogram, not a segmentation")]
    NotASegmentation {
        /// Number of distinct labels met.
        labels: usize,
    },
    /// None of the labels asked for is in the volume.
    #[error("none of the labels asked for ({asked}) is in the volume; it has {present}")]
    LabelsAbsent {
        /// The labels asked for.
        asked: String,
        /// The labels present.
        present: String,
    },
    /// A threshold must be a number.
    #[error("the threshold {0} is not usable: give a finite number")]
    Threshold(f64),
    /// The edge length is a length, or 0.
    #[error("the edge length {0} is not usable: give a positive length in the unit of the volume, or 0 to have it chosen")]
    EdgeLength(f64),
    /// Polylines that cannot be zipped.
    #[error("the polylines cannot be joined: {0}")]
    Polylines(String),
    /// A triangle mesh that cannot be measured.
    #[error("the triangles cannot be measured: {0}")]
    Triangles(String),
    /// Memory was refused.
    #[error("not enough memory: {0} bytes more were refused")]
    OutOfMemory(usize),
    /// More than 32 bits can number.
    #[error("{count} {what} are more than can be worked on at once, {limit}: extract fewer labels at a time, or a part of the volume")]
    TooMany {
        /// What there are so many of.
        what: &'static str,
        /// How many there would be.
        count: usize,
        /// The largest number that is accepted.
        limit: usize,
    },
    /// The thread pool could not be made.
    #[error("the worker threads could not be started: {0}")]
    Threads(String),
    /// Another process of the same run failed.
    #[error("process {process} failed: {message}")]
    Elsewhere {
        /// Its number, from 0.
        process: usize,
        /// Its message.
        message: String,
    },
    /// The pieces of the processes are not those of one volume.
    #[error("the segmentation is spread over several processes, whose parts do not make up one image: save it to a file and open that")]
    Pieces,
    /// The processes of a run are not told to do the same.
    #[error("the processes were given different options: all need the same labels, method and edge length")]
    OptionsDiffer,
    /// A process cannot be reached.
    #[error("the connection between the processes is broken")]
    Connection,
    /// The observer asked to stop.
    #[error("cancelled")]
    Cancelled,
}

/// A result with this crate's [`Error`].
pub type Result<T> = std::result::Result<T, Error>;

/// So many elements more were refused.
pub(crate) fn refused<T>(length: usize) -> Error {
    Error::OutOfMemory(length.saturating_mul(std::mem::size_of::<T>()))
}

/// An empty vector with room for `length` elements, or an error where memory is refused, as in all
/// functions below.
pub(crate) fn reserved<T>(length: usize) -> Result<Vec<T>> {
    let mut buffer = Vec::new();
    buffer
        .try_reserve_exact(length)
        .map_err(|_| refused::<T>(length))?;
    Ok(buffer)
}

/// Makes room for so many items more at least; a vector that grows in many small lots doubles, as
/// `Vec` itself does.
pub(crate) fn reserve<T>(items: &mut Vec<T>, more: usize) -> Result<()> {
    items.try_reserve(more).map_err(|_| refused::<T>(more))
}

/// Appends an item.
pub(crate) fn push<T>(items: &mut Vec<T>, item: T) -> Result<()> {
    if items.len() == items.capacity() {
        reserve(items, items.len().max(64))?;
    }
    items.push(item);
    Ok(())
}

/// Appends all that an iterator gives.
pub(crate) fn extend<T>(items: &mut Vec<T>, more: impl IntoIterator<Item = T>) -> Result<()> {
    let mut more = more.into_iter();
    reserve(items, more.size_hint().0)?;
    more.try_for_each(|item| push(items, item))
}

/// All that an iterator gives.
pub(crate) fn collected<T>(items: impl IntoIterator<Item = T>) -> Result<Vec<T>> {
    let mut collected = Vec::new();
    extend(&mut collected, items)?;
    Ok(collected)
}

/// So many copies of a value.
pub(crate) fn filled<T: Clone>(value: T, length: usize) -> Result<Vec<T>> {
    let mut buffer = reserved(length)?;
    buffer.resize(length, value);
    Ok(buffer)
}

/// A vector of `length` zeros by the allocator's own zeroing, which leaves touching the pages to the
/// workers.
pub(crate) fn zeros<T: Zeroable>(length: usize) -> Result<Vec<T>> {
    try_zeroed_vec(length).map_err(|()| refused::<T>(length))
}

/// Fails where so many things, each with so many parts, cannot be numbered in 32 bits.
pub(crate) fn check_count(what: &'static str, count: usize, parts: usize) -> Result<()> {
    // The last number, and that plus one, stand for none.
    let limit = (u32::MAX as usize - 2) / parts;
    if count > limit {
        return Err(Error::TooMany { what, count, limit });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_32_bits_cannot_number_is_refused() {
        let third = (1usize << 32) / 3;
        assert_eq!(check_count("triangles", (1 << 31) / 3 + 1, 3), Ok(()));
        assert_eq!(check_count("triangles", third - 1, 3), Ok(()));
        let refusal = check_count("triangles", third + 1, 3).expect_err("refused");
        assert!(
            refusal.to_string().contains("1431655766 triangles"),
            "{refusal}"
        );
        assert_eq!(check_count("points", (1 << 32) - 3, 1), Ok(()));
        assert!(check_count("points", (1 << 32) - 2, 1).is_err());
        assert!(check_count("points", usize::MAX, 1).is_err());
    }
}
