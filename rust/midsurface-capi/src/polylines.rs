//! Mid-polylines: out of a volume, in and out as arrays, and zipped to a mesh.

use midsurface::{Polyline, Polylines};

use crate::arguments::{address, collected, object};
use crate::error::{midsurface_error, midsurface_status};
use crate::exchange::midsurface_exchange;
use crate::handles::{make, make_in_team, make_of_piece, make_of_volume, release, show, told};
use crate::mesh::midsurface_mesh;
use crate::options::{self, midsurface_options};
use crate::piece::midsurface_piece;
use crate::polyline_arrays::{self, midsurface_polyline_arrays};
use crate::volume::midsurface_volume;

/// Polylines in the slices of a volume. Freed with midsurface_polylines_free.
#[derive(Debug)]
pub struct midsurface_polylines {
    polylines: Polylines,
    /// The lines' fields, an array each, as C takes them.
    offsets: Vec<i64>,
    connectivity: Vec<i64>,
    labels: Vec<i64>,
    components: Vec<i64>,
    slices: Vec<i64>,
}

impl midsurface_polylines {
    fn new(polylines: Polylines) -> Result<Self, midsurface_error> {
        let lines = &polylines.lines;
        // C reads as many values as the view says: arrays that are shorter must not get there.
        let point_count = polylines.points.len();
        assert_eq!(polylines.thickness.len(), point_count);
        assert_eq!(polylines.border_distance.len(), point_count);
        assert!(lines
            .iter()
            .all(|l| l.first <= point_count && l.count <= point_count - l.first));

        let entries = |line: &Polyline| line.count + usize::from(line.closed);
        let mut end = 0;
        let ends = lines.iter().map(|line| {
            end += entries(line);
            end as i64
        });
        Ok(Self {
            offsets: collected(lines.len() + 1, std::iter::once(0).chain(ends))?,
            connectivity: collected(
                lines.iter().map(entries).sum(),
                lines.iter().flat_map(|line| {
                    let first = line.first as i64;
                    let closing = line.closed.then_some(first);
                    (first..first + line.count as i64).chain(closing)
                }),
            )?,
            labels: collected(lines.len(), lines.iter().map(|line| line.label))?,
            components: collected(lines.len(), lines.iter().map(|line| line.component.into()))?,
            slices: collected(lines.len(), lines.iter().map(|line| line.slice))?,
            polylines,
        })
    }

    fn arrays(&self) -> midsurface_polyline_arrays {
        midsurface_polyline_arrays {
            points: address(self.polylines.points.as_flattened()),
            point_count: self.polylines.points.len(),
            thickness: address(&self.polylines.thickness),
            border_distance: address(&self.polylines.border_distance),
            offsets: address(&self.offsets),
            line_count: self.polylines.lines.len(),
            connectivity: address(&self.connectivity),
            connectivity_length: self.connectivity.len(),
            labels: address(&self.labels),
            components: address(&self.components),
            slices: address(&self.slices),
            voxel_steps: address(self.polylines.voxel_steps.as_flattened()),
        }
    }
}

/// Traces the mid-polylines of a label volume: the mid-surface's lines in every slice along z.
/// midsurface_zip makes midsurface_extract's surface of them.
///
/// volume, options: as described there.
/// out: where the new polylines go.
/// error: where an error goes; may be NULL.
#[no_mangle]
pub unsafe extern "C" fn midsurface_extract_polylines(
    volume: *const midsurface_volume,
    options: *const midsurface_options,
    out: *mut *mut midsurface_polylines,
    error: *mut *mut midsurface_error,
) -> midsurface_status {
    // SAFETY: the pointers are as the header describes.
    unsafe {
        make_of_volume(volume, options, out, error, |volume, options, callbacks| {
            midsurface_polylines::new(midsurface::mid_polylines(volume, options, callbacks)?)
        })
    }
}

/// Traces the mid-polylines of a label volume of which each of several processes holds a piece; each
/// gets those of whole components, as for midsurface_extract_piece.
///
/// piece: what this process holds, as described there.
/// exchange: how it reaches the others.
/// options: as described there.
/// out: where the new polylines go.
/// error: where an error goes; may be NULL.
#[no_mangle]
pub unsafe extern "C" fn midsurface_extract_polylines_piece(
    piece: *const midsurface_piece,
    exchange: *const midsurface_exchange,
    options: *const midsurface_options,
    out: *mut *mut midsurface_polylines,
    error: *mut *mut midsurface_error,
) -> midsurface_status {
    // SAFETY: the pointers are as the header describes.
    unsafe {
        make_of_piece(
            piece,
            exchange,
            options,
            out,
            error,
            |(piece, whole), options, team, callbacks| {
                let lines =
                    midsurface::mid_polylines_piece(piece, whole, options, team, callbacks)?;
                midsurface_polylines::new(lines)
            },
        )
    }
}

/// Makes polylines of arrays. The arrays are copied, a point as often as lines use it, and every
/// offset and index is checked, and that coordinates and thickness are finite.
///
/// arrays: the polylines, as described there.
/// out: where the new polylines go.
/// error: where an error goes; may be NULL.
#[no_mangle]
pub unsafe extern "C" fn midsurface_polylines_new(
    arrays: *const midsurface_polyline_arrays,
    out: *mut *mut midsurface_polylines,
    error: *mut *mut midsurface_error,
) -> midsurface_status {
    // SAFETY: the pointers are as the header describes.
    unsafe {
        make(out, error, || {
            midsurface_polylines::new(polyline_arrays::read(arrays)?)
        })
    }
}

/// Shows the arrays of polylines. Nothing is copied.
///
/// polylines: the polylines.
/// out: where the view goes.
/// error: where an error goes; may be NULL.
#[no_mangle]
pub unsafe extern "C" fn midsurface_polylines_arrays(
    polylines: *const midsurface_polylines,
    out: *mut midsurface_polyline_arrays,
    error: *mut *mut midsurface_error,
) -> midsurface_status {
    // SAFETY: the pointers are as the header describes.
    unsafe {
        let empty = midsurface_polyline_arrays::EMPTY;
        show(polylines, "polylines", out, empty, error, |polylines| {
            polylines.arrays()
        })
    }
}

/// Frees polylines. NULL is ignored.
#[no_mangle]
pub unsafe extern "C" fn midsurface_polylines_free(polylines: *mut midsurface_polylines) {
    // SAFETY: null, or polylines of this library that nobody uses any more.
    unsafe { release(polylines) };
}

/// Joins the polylines of neighbouring slices to a mesh. Its points are those of the lines, with the
/// steps of voxels flattened; midsurface_extract remeshes it.
///
/// polylines: the polylines; they stay as they are.
/// options: as described there; options.labels and options.edge_length are not looked at.
/// out: where the new mesh goes.
/// error: where an error goes; may be NULL.
#[no_mangle]
pub unsafe extern "C" fn midsurface_zip(
    polylines: *const midsurface_polylines,
    options: *const midsurface_options,
    out: *mut *mut midsurface_mesh,
    error: *mut *mut midsurface_error,
) -> midsurface_status {
    // SAFETY: the pointers are as the header describes.
    unsafe {
        make(out, error, || {
            let polylines = &object(polylines, "polylines")?.polylines;
            let (options, mut callbacks) = options::read(options)?;
            let mesh = midsurface::zip_polylines(polylines, &options, &mut callbacks)?;
            midsurface_mesh::new(mesh)
        })
    }
}

/// Joins the polylines that several processes have, those of each component on one of them. Each gets
/// the mesh of its lines. All processes have to call this at once; where one fails, all do.
///
/// polylines: the polylines of this process; they stay as they are.
/// exchange: how it reaches the others.
/// options: as described there.
/// out: where the new mesh goes.
/// error: where an error goes; may be NULL.
#[no_mangle]
pub unsafe extern "C" fn midsurface_zip_piece(
    polylines: *const midsurface_polylines,
    exchange: *const midsurface_exchange,
    options: *const midsurface_options,
    out: *mut *mut midsurface_mesh,
    error: *mut *mut midsurface_error,
) -> midsurface_status {
    // SAFETY: the pointers are as the header describes.
    unsafe {
        make_in_team(exchange, out, error, |team| {
            let (polylines, (options, mut callbacks)) = told(team, || {
                Ok((object(polylines, "polylines")?, options::read(options)?))
            })?;
            let lines = &polylines.polylines;
            let piece = midsurface::zip_polylines_piece(lines, &options, team, &mut callbacks)?;
            midsurface_mesh::new_piece(piece)
        })
    }
}
