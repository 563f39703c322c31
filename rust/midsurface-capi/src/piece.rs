//! A piece of a volume that is spread over processes, borrowed from the caller.

use std::ops::Range;

use midsurface::{Grid, Volume};

use crate::arguments::value;
use crate::error::midsurface_error;
use crate::volume::{self, midsurface_volume};

/// What one process holds of a label volume. Pieces may overlap, as where neighbours share a layer
/// of voxels, and all together have to cover the whole.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct midsurface_piece {
    /// The piece as a volume by itself; its extent_start tells where in the whole it lies. length
    /// 0: this process holds no voxel; then only spacing, origin and direction are looked at. These
    /// have to be the same in all processes.
    pub volume: midsurface_volume,
    /// Number of voxels of the whole volume along x, y, z.
    pub whole_dimensions: [usize; 3],
    /// Index of its first voxel along x, y, z in the image's extent.
    pub whole_extent_start: [i64; 3],
}

/// A piece of a volume, and the addresses of its scalars.
type Piece<'a> = (Volume<'a>, Range<usize>);

/// The piece, `None` where there is none, and where the voxels of the whole lie.
///
/// # Safety
/// `piece` is null or as the header describes, and its scalars outlive `'a`.
pub(crate) unsafe fn read<'a>(
    piece: *const midsurface_piece,
) -> Result<(Option<Piece<'a>>, Grid), midsurface_error> {
    // SAFETY: the same contract.
    let piece = unsafe { value(piece, "piece") }?;
    let whole = Grid {
        dimensions: piece.whole_dimensions,
        extent_start: piece.whole_extent_start,
        ..volume::grid(&piece.volume)
    };
    if piece.volume.length == 0 {
        return Ok((None, whole));
    }
    // SAFETY: the same contract.
    let read = unsafe { volume::read(&piece.volume) }?;
    Ok((Some(read), whole))
}
