//! The figures of a triangle mesh, as a table.

use midsurface::{Scope, Statistics, TriangleMesh};

use crate::arguments::{address, collected, optional_slice, slice, value};
use crate::error::{midsurface_error, midsurface_status};
use crate::exchange::midsurface_exchange;
use crate::handles::{look, make, make_in_team, release, told};

/// A triangle mesh of any origin. Borrowed for a call, never copied.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct midsurface_triangle_mesh {
    /// World coordinates, x y z: 3 * point_count values.
    pub points: *const f64,
    /// Number of points.
    pub point_count: usize,
    /// Point indices, three a triangle: 3 * triangle_count values.
    pub triangles: *const i64,
    /// Number of triangles.
    pub triangle_count: usize,
    /// Thickness at the points: point_count values, NaN where unknown. May be NULL: unknown.
    pub thickness: *const f32,
    /// Label of each triangle: triangle_count values. May be NULL: no rows for labels.
    pub labels: *const i64,
    /// Component of each triangle: triangle_count values. May be NULL: no rows for components.
    pub components: *const i64,
    /// Numbers of the points among those of all processes: point_count values. May be NULL: no point is
    /// another process's, too.
    pub point_ids: *const i64,
}

/// What a row is about.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum midsurface_scope {
    /// All triangles.
    Total = 0,
    /// Those of one label.
    Label,
    /// Those of one component, of one label where labels are known.
    Component,
}

/// A row of the table. Lengths are in the unit of the points.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct midsurface_statistics_row {
    /// What the row is about.
    pub scope: midsurface_scope,
    /// Whether the row is about one label.
    pub has_label: bool,
    /// The label; 0 without.
    pub label: i64,
    /// The component; 0 where scope is another.
    pub component: i64,
    /// Number of points in use.
    pub points: usize,
    /// Number of triangles.
    pub triangles: usize,
    /// Area of all triangles.
    pub area: f64,
    /// Points - edges + triangles: 2 for a sphere, 1 for a disk, 0 for a torus or an open tube.
    pub euler_number: i64,
    /// Length of all edges with one triangle; 0 for a closed surface.
    pub boundary_length: f64,
    /// Number of connected rims; 0 for a closed surface.
    pub boundary_loops: usize,
    /// Mean thickness at the points; NaN where unknown.
    pub thickness_mean: f64,
    /// 5 %, 25 %, 50 % (the median), 75 % and 95 % of the points are at most this thick; NaN where
    /// unknown.
    pub thickness_quantiles: [f64; 5],
    /// Smallest shape factor of the triangles; 1 is equilateral.
    pub quality_smallest: f64,
    /// Mean of the shape factors.
    pub quality_mean: f64,
    /// Mean of the triangles' smallest angles, degrees.
    pub mean_smallest_angle: f64,
    /// Share of the angles under 30 degrees, 0 to 1.
    pub share_under_30: f64,
    /// Share of the angles over 120 degrees, 0 to 1.
    pub share_over_120: f64,
    /// Share of the points off the boundary that have five, six or seven edges, 0 to 1.
    pub valence_567: f64,
}

impl From<Statistics> for midsurface_statistics_row {
    fn from(row: Statistics) -> Self {
        let (scope, label, component) = match row.scope {
            Scope::Total => (midsurface_scope::Total, None, 0),
            Scope::Label(label) => (midsurface_scope::Label, Some(label), 0),
            Scope::Component { label, component } => {
                (midsurface_scope::Component, label, component)
            }
        };
        Self {
            scope,
            has_label: label.is_some(),
            label: label.unwrap_or(0),
            component,
            points: row.points,
            triangles: row.triangles,
            area: row.quality.area,
            euler_number: row.euler_number,
            boundary_length: row.boundary_length,
            boundary_loops: row.boundary_loops,
            thickness_mean: row.thickness.map_or(f64::NAN, |t| t.mean),
            thickness_quantiles: row.thickness.map_or([f64::NAN; 5], |t| t.quantiles),
            quality_smallest: row.quality.smallest,
            quality_mean: row.quality.mean,
            mean_smallest_angle: row.quality.mean_smallest_angle,
            share_under_30: row.quality.share_under_30,
            share_over_120: row.quality.share_over_120,
            valence_567: row.quality.valence_567,
        }
    }
}

/// The table of a mesh's figures. Freed with midsurface_statistics_free.
#[derive(Debug)]
pub struct midsurface_statistics(Vec<midsurface_statistics_row>);

/// Measures a mesh: a row in total, then one for each label, in ascending order, followed by one
/// for each of its components.
///
/// mesh: as described there. Its indices are checked, and that coordinates are finite.
/// out: where the new table goes.
/// error: where an error goes; may be NULL.
#[no_mangle]
pub unsafe extern "C" fn midsurface_measure(
    mesh: *const midsurface_triangle_mesh,
    out: *mut *mut midsurface_statistics,
    error: *mut *mut midsurface_error,
) -> midsurface_status {
    // SAFETY: the pointers are as the header describes.
    unsafe {
        make(out, error, || {
            let mesh = read(mesh)?;
            table(midsurface::statistics(&mesh)?)
        })
    }
}

/// Measures a mesh of which each of several processes holds a piece, as midsurface_extract_piece makes
/// them: as midsurface_measure does, in all. Where a component is that of several processes the numbers of
/// its points have to be known; none of them gets the mesh of another. All processes have to call this at
/// once; the first gets the table, the others an empty one.
///
/// mesh: what this process holds, maybe nothing.
/// exchange: how it reaches the others.
/// out: where the new table goes.
/// error: where an error goes; may be NULL.
#[no_mangle]
pub unsafe extern "C" fn midsurface_measure_pieces(
    mesh: *const midsurface_triangle_mesh,
    exchange: *const midsurface_exchange,
    out: *mut *mut midsurface_statistics,
    error: *mut *mut midsurface_error,
) -> midsurface_status {
    // SAFETY: the pointers are as the header describes.
    unsafe {
        make_in_team(exchange, out, error, |team| {
            let mesh = told(team, || read(mesh))?;
            table(midsurface::statistics_of_pieces(&mesh, team)?)
        })
    }
}

/// The core's mesh.
///
/// # Safety
/// `mesh` is null or as the header describes, and its arrays outlive `'a`.
unsafe fn read<'a>(
    mesh: *const midsurface_triangle_mesh,
) -> Result<TriangleMesh<'a>, midsurface_error> {
    // SAFETY: the same contract.
    unsafe {
        let mesh = value(mesh, "mesh")?;
        let (points, triangles) = (mesh.point_count, mesh.triangle_count);
        Ok(TriangleMesh {
            points: slice(mesh.points.cast(), points, "mesh.points")?,
            triangles: slice(mesh.triangles.cast(), triangles, "mesh.triangles")?,
            thickness: optional_slice(mesh.thickness, points, "mesh.thickness")?,
            labels: optional_slice(mesh.labels, triangles, "mesh.labels")?,
            components: optional_slice(mesh.components, triangles, "mesh.components")?,
            point_ids: optional_slice(mesh.point_ids, points, "mesh.point_ids")?,
        })
    }
}

fn table(rows: Vec<Statistics>) -> Result<midsurface_statistics, midsurface_error> {
    let rows = collected(rows.len(), rows.into_iter().map(Into::into))?;
    Ok(midsurface_statistics(rows))
}

/// Number of rows of a table; 0 for NULL.
#[no_mangle]
pub unsafe extern "C" fn midsurface_statistics_length(
    statistics: *const midsurface_statistics,
) -> usize {
    // SAFETY: null, or a table of this library.
    unsafe { look(statistics, 0, |statistics| statistics.0.len()) }
}

/// The rows of a table, midsurface_statistics_length of them, valid until it is freed; NULL for
/// NULL.
#[no_mangle]
pub unsafe extern "C" fn midsurface_statistics_rows(
    statistics: *const midsurface_statistics,
) -> *const midsurface_statistics_row {
    // SAFETY: null, or a table of this library.
    unsafe { look(statistics, std::ptr::null(), |s| address(&s.0)) }
}

/// Frees a table. NULL is ignored.
#[no_mangle]
pub unsafe extern "C" fn midsurface_statistics_free(statistics: *mut midsurface_statistics) {
    // SAFETY: null, or a table of this library that nobody uses any more.
    unsafe { release(statistics) };
}
