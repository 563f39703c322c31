//! Distance and ridge field, written into arrays of the caller's.

use std::ops::Range;

use midsurface::Volume;
use ndarray::ArrayViewMut3;

use crate::arguments::{check_array, cleared};
use crate::error::{guarded, midsurface_error, midsurface_status};
use crate::options::{self, midsurface_options};
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
            check_length(&volume, length)?;
            check_arrays(distance, ridge, length, &scalars)?;
            let distance = shaped(cleared(distance, length, "distance")?, &volume)?;
            let ridge = shaped(cleared(ridge, length, "ridge")?, &volume)?;
            midsurface::ridge_field(&volume, &options, &mut callbacks, distance, ridge)?;
            Ok(())
        })
    }
}

fn check_length(volume: &Volume, length: usize) -> Result<(), midsurface_error> {
    let voxels = volume.grid().voxel_count()?;
    if length != voxels {
        return Err(midsurface_error::invalid(format!(
            "`length` is {length}, but `distance` and `ridge` need one float for each of {voxels} \
             voxels"
        )));
    }
    Ok(())
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

fn shaped<'a>(
    values: &'a mut [f32],
    volume: &Volume,
) -> Result<ArrayViewMut3<'a, f32>, midsurface_error> {
    let [x, y, z] = volume.grid().dimensions;
    ArrayViewMut3::from_shape((z, y, x), values)
        .map_err(|error| midsurface_error::invalid(error.to_string()))
}
