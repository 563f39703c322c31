//! The mesh, and the run that makes it from a volume.

use midsurface::{Mesh, MeshPiece};

use crate::arguments::{address, collected, object};
use crate::error::{guarded, midsurface_error, midsurface_status};
use crate::exchange::midsurface_exchange;
use crate::handles::{make_of_piece, make_of_volume, release, show};
use crate::options::midsurface_options;
use crate::piece::midsurface_piece;
use crate::volume::midsurface_volume;

/// A triangle mesh: a 2-manifold with boundary, consistently wound in each component. Freed with
/// midsurface_mesh_free.
#[derive(Debug)]
pub struct midsurface_mesh {
    mesh: Mesh,
    point_ids: Vec<i64>,
    first_triangle: u64,
    /// Indices as C takes them.
    triangles: Vec<[i64; 3]>,
    components: Vec<i64>,
}

impl midsurface_mesh {
    pub(crate) fn new(mesh: Mesh) -> Result<Self, midsurface_error> {
        Self::new_piece(MeshPiece {
            mesh,
            ..MeshPiece::default()
        })
    }

    pub(crate) fn new_piece(piece: MeshPiece) -> Result<Self, midsurface_error> {
        let mesh = piece.mesh;
        // C reads as many values as the view says: arrays that are shorter must not get there.
        assert_eq!(mesh.normals.len(), mesh.points.len());
        assert_eq!(mesh.thickness.len(), mesh.points.len());
        assert!([0, mesh.points.len()].contains(&piece.point_ids.len()));
        assert_eq!(mesh.labels.len(), mesh.triangles.len());
        assert_eq!(mesh.components.len(), mesh.triangles.len());
        let triangles = mesh.triangles.iter().map(|t| t.map(i64::from));
        let components = mesh.components.iter().copied().map(i64::from);
        Ok(Self {
            triangles: collected(mesh.triangles.len(), triangles)?,
            components: collected(mesh.components.len(), components)?,
            point_ids: piece.point_ids,
            first_triangle: piece.first_triangle,
            mesh,
        })
    }

    fn arrays(&self) -> midsurface_mesh_arrays {
        let mesh = &self.mesh;
        midsurface_mesh_arrays {
            points: address(mesh.points.as_flattened()),
            point_count: mesh.points.len(),
            normals: address(mesh.normals.as_flattened()),
            thickness: address(&mesh.thickness),
            triangles: address(self.triangles.as_flattened()),
            triangle_count: mesh.triangles.len(),
            labels: address(&mesh.labels),
            components: address(&self.components),
            point_ids: address(&self.point_ids),
            first_triangle: self.first_triangle,
        }
    }
}

/// The arrays of a mesh: a view into it, valid until it is freed. Arrays of length 0 are NULL.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct midsurface_mesh_arrays {
    /// World coordinates, x y z: 3 * point_count values.
    pub points: *const f32,
    /// Number of points.
    pub point_count: usize,
    /// Unit normals of the points, x y z: 3 * point_count values. They agree with the winding:
    /// seen from the side they point to, a triangle's corners run counter-clockwise.
    pub normals: *const f32,
    /// Local thickness at the points, in the unit of the spacing: point_count values.
    pub thickness: *const f32,
    /// Point indices, three a triangle: 3 * triangle_count values.
    pub triangles: *const i64,
    /// Number of triangles.
    pub triangle_count: usize,
    /// Label of each triangle: triangle_count values.
    pub labels: *const i64,
    /// Component of each triangle: the label's 26-connected component, numbered from 0 by label,
    /// then by size, the largest first; triangle_count values.
    pub components: *const i64,
    /// Numbers of the points among those of all processes, point_count values; NULL for a mesh of
    /// midsurface_extract. A point that is another process's, too, has the same number there.
    pub point_ids: *const i64,
    /// Number of the first triangle among those of all processes; 0 where there is one.
    pub first_triangle: u64,
}

impl midsurface_mesh_arrays {
    const EMPTY: Self = Self {
        points: std::ptr::null(),
        point_count: 0,
        normals: std::ptr::null(),
        thickness: std::ptr::null(),
        triangles: std::ptr::null(),
        triangle_count: 0,
        labels: std::ptr::null(),
        components: std::ptr::null(),
        point_ids: std::ptr::null(),
        first_triangle: 0,
    };
}

/// Extracts the mid-surface of a label volume. A volume without labels gives an empty mesh and a
/// warning.
///
/// volume, options: as described there.
/// out: where the new mesh goes.
/// error: where an error goes; may be NULL.
#[no_mangle]
pub unsafe extern "C" fn midsurface_extract(
    volume: *const midsurface_volume,
    options: *const midsurface_options,
    out: *mut *mut midsurface_mesh,
    error: *mut *mut midsurface_error,
) -> midsurface_status {
    // SAFETY: the pointers are as the header describes.
    unsafe {
        make_of_volume(volume, options, out, error, |volume, options, callbacks| {
            midsurface_mesh::new(midsurface::extract(volume, options, callbacks)?)
        })
    }
}

/// Extracts the mid-surface of a label volume of which each of several processes holds a piece. Each
/// process gets the mesh of whole components, numbered as in the whole volume, or an empty one. Of the
/// ridge surface of a component of more than four million voxels each gets a part: only then the meshes
/// share points, and never triangles. All together are midsurface_extract's mesh. All processes have to
/// call this at once, with the same options; where one fails, all do. Warnings about the whole volume
/// come in the first process.
///
/// piece: what this process holds, as described there.
/// exchange: how it reaches the others.
/// options: as described there.
/// out: where the new mesh goes.
/// error: where an error goes; may be NULL.
#[no_mangle]
pub unsafe extern "C" fn midsurface_extract_piece(
    piece: *const midsurface_piece,
    exchange: *const midsurface_exchange,
    options: *const midsurface_options,
    out: *mut *mut midsurface_mesh,
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
                let piece = midsurface::extract_piece(piece, whole, options, team, callbacks)?;
                midsurface_mesh::new_piece(piece)
            },
        )
    }
}

/// Shows the arrays of a mesh. Nothing is copied.
///
/// mesh: the mesh.
/// out: where the view goes.
/// error: where an error goes; may be NULL.
#[no_mangle]
pub unsafe extern "C" fn midsurface_mesh_view(
    mesh: *const midsurface_mesh,
    out: *mut midsurface_mesh_arrays,
    error: *mut *mut midsurface_error,
) -> midsurface_status {
    // SAFETY: the pointers are as the header describes.
    unsafe {
        let empty = midsurface_mesh_arrays::EMPTY;
        show(mesh, "mesh", out, empty, error, |mesh| mesh.arrays())
    }
}

/// Checks that a mesh is a 2-manifold with boundary, consistently wound, with nothing duplicate,
/// degenerate or unused. A mesh of this library is; a failure, with
/// MIDSURFACE_STATUS_INVALID_ARGUMENT and a message that says what is wrong where, is a bug.
///
/// mesh: the mesh.
/// error: where an error goes; may be NULL.
#[no_mangle]
pub unsafe extern "C" fn midsurface_mesh_check(
    mesh: *const midsurface_mesh,
    error: *mut *mut midsurface_error,
) -> midsurface_status {
    // SAFETY: the pointers are as the header describes.
    unsafe {
        guarded(error, || {
            let violation = object(mesh, "mesh")?.mesh.check_invariants();
            violation.map_err(|violation| midsurface_error::invalid(violation.to_string()))
        })
    }
}

/// Frees a mesh. NULL is ignored.
#[no_mangle]
pub unsafe extern "C" fn midsurface_mesh_free(mesh: *mut midsurface_mesh) {
    // SAFETY: null, or a mesh of this library that nobody uses any more.
    unsafe { release(mesh) };
}
