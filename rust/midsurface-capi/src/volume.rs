//! The input volume, borrowed from the caller.

use std::ffi::c_void;
use std::ops::Range;

use midsurface::{Error, Grid, Label, Volume};

use crate::arguments::{check_array, slice, value};
use crate::error::{guarded_value, midsurface_error};

/// The type of a volume's scalars: values for the field `scalar_type` of midsurface_volume.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum midsurface_scalar_type {
    /// 8-bit signed integer.
    Int8 = 0,
    /// 8-bit unsigned integer.
    Uint8,
    /// 16-bit signed integer.
    Int16,
    /// 16-bit unsigned integer.
    Uint16,
    /// 32-bit signed integer.
    Int32,
    /// 32-bit unsigned integer.
    Uint32,
    /// 64-bit signed integer.
    Int64,
    /// 64-bit unsigned integer, at most 2^63 - 1.
    Uint64,
    /// 32-bit floating point, whole numbers only.
    Float32,
    /// 64-bit floating point, whole numbers only.
    Float64,
}

/// A label volume: an integer a voxel, 0 for background; or a map, such as a probability, of which
/// everything at or above a threshold is label 1. Borrowed for a call, never copied.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct midsurface_volume {
    /// The labels, x fastest, then y, then z; aligned as their type.
    pub scalars: *const c_void,
    /// Number of scalars in the array. Must be the product of dimensions; this is checked before
    /// any of them is read.
    pub length: usize,
    /// A midsurface_scalar_type; any other value is refused.
    pub scalar_type: u32,
    /// Number of voxels along x, y, z.
    pub dimensions: [usize; 3],
    /// Index of the first voxel along x, y, z in the image's extent; 0, 0, 0 for most images.
    pub extent_start: [i64; 3],
    /// Distance between voxel centres along x, y, z: positive, finite.
    pub spacing: [f64; 3],
    /// World coordinates of the voxel with extent index (0, 0, 0).
    pub origin: [f64; 3],
    /// Row-major 3x3 matrix, not singular, whose columns are the image's axes in world
    /// coordinates; 1 0 0 0 1 0 0 0 1 for most images.
    pub direction: [f64; 9],
    /// Whether the scalars are a map, of any values, with a threshold. False for labels.
    pub use_threshold: bool,
    /// Where use_threshold: the least value of label 1, finite; else not looked at.
    pub threshold: f64,
}

/// The addresses of an array's bytes.
pub(crate) fn addresses<T>(array: *const T, length: usize) -> Range<usize> {
    array.addr()..array.addr() + length * size_of::<T>()
}

/// The core's volume, and the addresses of its scalars.
///
/// # Safety
/// `volume` is null or as the header describes, and its scalars outlive `'a`.
pub(crate) unsafe fn read<'a>(
    volume: *const midsurface_volume,
) -> Result<(Volume<'a>, Range<usize>), midsurface_error> {
    use midsurface_scalar_type as Type;
    // SAFETY: the same contract.
    let volume = unsafe { value(volume, "volume") }?;
    let scalar_type = scalar_type(volume.scalar_type)?;
    // SAFETY: the same contract.
    unsafe {
        match scalar_type {
            Type::Int8 => borrow::<i8>(&volume),
            Type::Uint8 => borrow::<u8>(&volume),
            Type::Int16 => borrow::<i16>(&volume),
            Type::Uint16 => borrow::<u16>(&volume),
            Type::Int32 => borrow::<i32>(&volume),
            Type::Uint32 => borrow::<u32>(&volume),
            Type::Int64 => borrow::<i64>(&volume),
            Type::Uint64 => borrow::<u64>(&volume),
            Type::Float32 => borrow::<f32>(&volume),
            Type::Float64 => borrow::<f64>(&volume),
        }
    }
}

fn scalar_type(number: u32) -> Result<midsurface_scalar_type, midsurface_error> {
    use midsurface_scalar_type as Type;
    [
        Type::Int8,
        Type::Uint8,
        Type::Int16,
        Type::Uint16,
        Type::Int32,
        Type::Uint32,
        Type::Int64,
        Type::Uint64,
        Type::Float32,
        Type::Float64,
    ]
    .into_iter()
    .find(|&known| known as u32 == number)
    .ok_or_else(|| {
        midsurface_error::invalid(format!(
            "`volume.scalar_type` is {number}, which is no midsurface_scalar_type"
        ))
    })
}

/// Where the voxels lie.
pub(crate) fn grid(volume: &midsurface_volume) -> Grid {
    let d = volume.direction;
    Grid {
        dimensions: volume.dimensions,
        extent_start: volume.extent_start,
        spacing: volume.spacing,
        origin: volume.origin,
        direction: [[d[0], d[1], d[2]], [d[3], d[4], d[5]], [d[6], d[7], d[8]]],
    }
}

/// # Safety
/// As for [`read`], the scalars being of type `T`.
unsafe fn borrow<'a, T: Label + 'a>(
    volume: &midsurface_volume,
) -> Result<(Volume<'a>, Range<usize>), midsurface_error> {
    let grid = grid(volume);
    if grid.voxel_count()? != volume.length {
        return Err(Error::BufferLength {
            dimensions: volume.dimensions,
            length: volume.length,
        }
        .into());
    }
    // SAFETY: as the header describes; the length has just been checked.
    let scalars: &[T] = unsafe { slice(volume.scalars.cast(), volume.length, "volume.scalars") }?;
    let addresses = addresses(scalars.as_ptr(), scalars.len());
    let mut read = Volume::new(scalars, grid)?;
    if volume.use_threshold {
        read = read.with_threshold(volume.threshold)?;
    }
    Ok((read, addresses))
}

/// Tells whether an image's z spacing is its number of slices times its x spacing: what readers
/// make of an MRC file whose header lacks the number of slices (mz = 1). The functions that take a
/// volume work with its spacing as it is; this is for callers that want to correct it.
///
/// dimensions: number of voxels of the whole image along x, y, z; 3 values.
/// spacing: its spacing along x, y, z; 3 values.
/// meant: room for 3 values. Filled with the spacing that is meant, z as x, where the answer is
/// true; else left as it is.
///
/// False, too, where a pointer is NULL, and for images of fewer than 16 voxels along an axis, of
/// which slices may well be that thick.
#[no_mangle]
pub unsafe extern "C" fn midsurface_unstretched_spacing(
    dimensions: *const usize,
    spacing: *const f64,
    meant: *mut f64,
) -> bool {
    // SAFETY: the pointers are null or as the header describes.
    guarded_value(false, || unsafe {
        let (Ok(dimensions), Ok(spacing), Ok(())) = (
            slice(dimensions, 3, "dimensions"),
            slice(spacing, 3, "spacing"),
            check_array(meant, 3, "meant"),
        ) else {
            return false;
        };
        let dimensions = [dimensions[0], dimensions[1], dimensions[2]];
        let spacing = [spacing[0], spacing[1], spacing[2]];
        let found = Grid::unstretched_spacing(dimensions, spacing);
        if let Some(found) = found {
            meant.cast::<[f64; 3]>().write(found);
        }
        found.is_some()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A 2×3×4 volume of `scalars`.
    fn volume<T>(scalars: &[T], scalar_type: midsurface_scalar_type) -> midsurface_volume {
        midsurface_volume {
            scalars: scalars.as_ptr().cast(),
            length: scalars.len(),
            scalar_type: scalar_type as u32,
            dimensions: [2, 3, 4],
            extent_start: [-1, 0, 5],
            spacing: [1.0, 2.0, 3.0],
            origin: [10.0, 20.0, 30.0],
            direction: [1.0, 2.0, 3.0, 0.0, 1.0, 4.0, 0.0, 0.0, 1.0],
            use_threshold: false,
            threshold: 0.0,
        }
    }

    fn refusal(volume: &midsurface_volume) -> String {
        match unsafe { read(volume) } {
            Ok(_) => panic!("accepted"),
            Err(error) => format!("{error:?}"),
        }
    }

    #[test]
    fn the_frame_arrives_unchanged() {
        let volume = volume(&[0_u8; 24], midsurface_scalar_type::Uint8);
        let (read, _) = unsafe { read(&volume) }.expect("usable");
        let grid = read.grid();
        assert_eq!(grid.dimensions, volume.dimensions);
        assert_eq!(grid.extent_start, volume.extent_start);
        assert_eq!(grid.spacing, volume.spacing);
        assert_eq!(grid.origin, volume.origin);
        let direction = [[1.0, 2.0, 3.0], [0.0, 1.0, 4.0], [0.0, 0.0, 1.0]];
        assert_eq!(grid.direction, direction);
    }

    #[test]
    fn every_scalar_type_is_known_and_no_other() {
        for number in 0..=9 {
            assert_eq!(scalar_type(number).expect("known") as u32, number);
        }
        assert!(scalar_type(10).is_err());
        assert!(scalar_type(u32::MAX).is_err());
    }

    #[test]
    fn a_length_that_overflows_is_refused_before_the_scalars_are_touched() {
        let mut volume = volume(&[0_u64; 24], midsurface_scalar_type::Uint64);
        volume.scalars = std::ptr::dangling::<u64>().cast();
        volume.dimensions = [usize::MAX, 2, 1];
        assert!(refusal(&volume).contains("too large"));
        // One below the limit for voxels, but eight bytes each.
        volume.dimensions = [1 << 30, 1 << 30, 4];
        volume.length = 1 << 62;
        assert!(refusal(&volume).contains("more than memory can"));
        volume.dimensions = [2, 3, 4];
        volume.length = 23;
        assert!(refusal(&volume).contains("holds 23 values"));
    }

    #[test]
    fn misaligned_scalars_are_refused() {
        let scalars = [0_i32; 25];
        let mut volume = volume(&scalars[..24], midsurface_scalar_type::Int32);
        volume.scalars = scalars.as_ptr().cast::<u8>().wrapping_add(1).cast();
        assert!(refusal(&volume).contains("multiple of 4 bytes"));
    }
}
