//! Distance and ridge field, written into arrays of the caller's.

use std::ops::Range;

use midsurface::Volume;
use ndarray::{ArrayViewMut3, ShapeError};

use crate::arguments::{check_array, cleared};
use crate::error::{guarded, midsurface_error, midsurface_status};
use crate::exchange::{self, midsurface_exchange};
use crate::handles::told;
use crate::options::{self, midsurface_options};
use crate::piece::{self, midsurface_piece};
use crate::volume::{self, addresses, midsurface_volume};

/// Computes the distance to the nearest face of the label and the ridge field, whose crests are
/// the mid-surface.
///
/// volume, options: as described there.
/// distance: the caller's array of one float a voxel, in the order of the scalars; it may be
/// uninitialised. Filled with the Euclidean distance of each labelled voxel to the nearest voxel
/// outside its label, in units of the spacing; 0 elsewhere.
/// ridge: another such array, not overlapping the first. Filled with the ridge field, in
/// units of the spacing too; 0 away from the labels.
/// length: number of floats in each array; must be the number of voxels.
/// error: where an error goes; may be NULL. On failure the arrays' contents mean nothing.
#[no_mangle]
pub unsafe extern "C" fn midsurface_ridge_field(
    volume: *const midsurface_volume,
    options: *const midsurface_options,
    distance: *mut f32,
    ridge: *mut f32,
    length: usize,
    error: *mut *mut midsurface_error,
) -> midsurface_status {
    // SAFETY: the pointers are as the header describes.
    unsafe {
        guarded(error, || {
            let (volume, scalars) = volume::read(volume)?;
            let (options, mut callbacks) = options::read(options)?;
            let volume = &volume;
            let [distance, ridge] = arrays(Some((volume, &scalars)), [distance, ridge], length)?;
            midsurface::ridge_field(volume, &options, &mut callbacks, distance, ridge)?;
            Ok(())
        })
    }
}

/// Computes distance and ridge field, as midsurface_ridge_field, of a label volume of which each of
/// several processes holds a piece. All processes have to call this at once, with the same options;
/// where one fails, all do.
///
/// piece: what this process holds, as described there.
/// exchange: how it reaches the others.
/// options: as described there.
/// distance, ridge, length: as for midsurface_ridge_field, of the piece; length 0 where the process
/// holds no voxel.
/// error: where an error goes; may be NULL. On failure the arrays' contents mean nothing.
#[no_mangle]
pub unsafe extern "C" fn midsurface_ridge_field_piece(
    piece: *const midsurface_piece,
    exchange: *const midsurface_exchange,
    options: *const midsurface_options,
    distance: *mut f32,
    ridge: *mut f32,
    length: usize,
    error: *mut *mut midsurface_error,
) -> midsurface_status {
    // SAFETY: the pointers are as the header describes.
    unsafe {
        guarded(error, || {
            let mut team = exchange::read(exchange)?;
            let (piece, whole, (options, mut callbacks), [distance, ridge]) =
                told(&mut team, || {
                    let (piece, whole) = piece::read(piece)?;
                    let options = options::read(options)?;
                    let known = piece.as_ref().map(|(volume, scalars)| (volume, scalars));
                    let arrays = arrays(known, [distance, ridge], length)?;
                    Ok((piece, whole, options, arrays))
                })?;
            let volume = piece.as_ref().map(|(volume, _)| volume);
            let (team, callbacks) = (&mut team, &mut callbacks);
            midsurface::ridge_field_piece(
                volume, &whole, &options, team, callbacks, distance, ridge,
            )?;
            Ok(())
        })
    }
}

/// The caller's arrays for distance and ridge field, cleared, in the shape of a volume, given with the
/// addresses of its scalars.
///
/// # Safety
/// As for [`cleared`], for each of the arrays.
unsafe fn arrays<'a>(
    volume: Option<(&Volume, &Range<usize>)>,
    [distance, ridge]: [*mut f32; 2],
    length: usize,
) -> Result<[ArrayViewMut3<'a, f32>; 2], midsurface_error> {
    let dimensions = volume.map_or([0; 3], |(volume, _)| volume.grid().dimensions);
    let voxels = volume.map_or(Ok(0), |(volume, _)| volume.grid().voxel_count())?;
    if length != voxels {
        return Err(midsurface_error::invalid(format!(
            "`length` is {length}, but `distance` and `ridge` need one float for each of {voxels} \
             voxels"
        )));
    }
    if let Some((_, scalars)) = volume {
        check_arrays(distance, ridge, length, scalars)?;
    }
    // SAFETY: the same contract.
    let arrays = unsafe {
        [
            cleared(distance, length, "distance")?,
            cleared(ridge, length, "ridge")?,
        ]
    };
    let [x, y, z] = dimensions;
    let [distance, ridge] = arrays.map(|values| ArrayViewMut3::from_shape((z, y, x), values));
    let refusal = |error: ShapeError| midsurface_error::invalid(error.to_string());
    Ok([distance.map_err(refusal)?, ridge.map_err(refusal)?])
}

/// Arrays that share memory would be read and written at once.
fn check_arrays(
    distance: *const f32,
    ridge: *const f32,
    length: usize,
    scalars: &Range<usize>,
) -> Result<(), midsurface_error> {
    if length == 0 {
        return Ok(());
    }
    check_array(distance, length, "distance")?;
    check_array(ridge, length, "ridge")?;
    let distance = addresses(distance, length);
    let ridge = addresses(ridge, length);
    for (one, other, names) in [
        (&distance, &ridge, "`distance` and `ridge`"),
        (&distance, scalars, "`distance` and `volume.scalars`"),
        (&ridge, scalars, "`ridge` and `volume.scalars`"),
    ] {
        if one.start < other.end && other.start < one.end {
            return Err(midsurface_error::invalid(format!(
                "{names} overlap in memory"
            )));
        }
    }
    Ok(())
}
