//! Mid-surfaces of thin labelled slabs in segmented volumes.
//!
//! A cell membrane in a segmented tomogram is a slab of labelled voxels, 2 to 15 thick. This crate
//! finds the surface midway between its two faces, as a triangle mesh. Data flows one way; a folder is
//! a part of that way, a stage is a file. Both methods begin with
//!
//! | stage | from → to | where |
//! | --- | --- | --- |
//! | scan | volume → runs of labelled voxels, the only pass over the input | `reading/runs.rs` |
//! | parts | runs → connected parts, each with its label and component | `reading/components.rs` |
//! | distance | parts → distance to the outside, in sparse bricks | `fields/distance.rs` |
//!
//! The ridge surface (`ridge_surface.rs`) goes on in all three directions at once:
//!
//! | stage | from → to | where |
//! | --- | --- | --- |
//! | sheets | distance → normal and offset of the sheet at every voxel near it | `sheets` |
//! | contour | sheets → a surface through them, cut at the label's rims, without creases where sheets meet, nor false holes | `contour` |
//! | midway | surface → surface midway between both faces, with smooth rims, led on to where sheets meet | `midway` |
//! | mesh | triangles → nearly equilateral ones | `remesh` |
//! | finish | mesh → mesh without terraces, sharp triangles or self-intersections | `finish` |
//!
//! The polyline zipper (`zipper`) is the method of Boneš et al., "MidSurfer: A Parameter-Free Approach for
//! Mid-Surface Extraction from Segmented Volumetric Data" (arXiv 2405.19339):
//!
//! | stage | from → to | where |
//! | --- | --- | --- |
//! | ridge field | distance → a smooth field whose crest is the mid-surface | `zipper/ridge.rs` |
//! | polylines | ridge field → a line midway through every slice | `zipper/polylines.rs` |
//! | zipper | polylines → strips of triangles between slices | `zipper/zip.rs` |
//! | mesh | triangles → a surface without terraces, then nearly equilateral triangles | `zipper/zipped_surface.rs`, `remesh` |
//!
//! Surfaces of both are held as in `surface`, and measured as in `statistics`.
//!
//! Arrays are in the order x, y, z, volumes have shape (z, y, x) with x fastest. Lengths inside
//! are in units of the finest spacing, so that the same voxels in other units give the same mesh;
//! `grid.rs` tells the frames. Everything between scan and polylines, or the ridge surface, happens in
//! batches of whole components, two side by side (`extraction.rs`, `batches.rs`), so that memory follows
//! the largest batches, and depends on places in the volume only, never on the order of work: any number
//! of threads gives the same mesh. A component that is larger than a batch should be is cut into tiles
//! (`lots.rs`, `tiles`) for the ridge surface. Processes that hold a piece of the volume each give the
//! same mesh, too, however many they are (`processes`): they swap runs until each has whole components,
//! and what follows is the same; tiles are dealt to all processes, which swap what lies between them.
#![forbid(unsafe_code)]

mod batches;
mod buckets;
mod contour;
mod error;
mod execution;
mod extraction;
mod fields;
mod findings;
mod finish;
mod grid;
mod hash;
#[cfg(feature = "inject-panics")]
pub mod injected_panics;
mod lots;
mod mesh;
mod midway;
mod processes;
mod reading;
mod remesh;
mod ridge_surface;
mod sheets;
mod statistics;
mod surface;
mod tiles;
mod zipper;

use ndarray::ArrayViewMut3;

pub use error::{Error, Result};
use execution::Execution;
pub use execution::{Observer, Quiet};
use extraction::find_surface;
use findings::Findings;
pub use grid::{Grid, Vec3};
use lots::Sizes;
pub use mesh::{InvariantViolation, Mesh};
pub use processes::exchange::{abandon, Exchange};
use processes::exchange::{Alone, Team};
pub use processes::{
    extract_piece, mid_polylines_piece, ridge_field_piece, zip_polylines_piece, MeshPiece,
};
use reading::read_parts;
pub use reading::volume::{Label, Scalars, Volume};
pub use statistics::quality::Quality;
pub use statistics::{
    statistics, statistics_of_pieces, Scope, Statistics, ThicknessFigures, TriangleMesh,
};
pub use zipper::polylines::{Polyline, Polylines};
use zipper::zipped_surface::zipped_surface;
use zipper::{trace_polylines, write_fields, Fields};

/// How the mid-surface is found.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Method {
    /// The paper's method: a line in every slice along z, neighbouring lines zipped together.
    PolylineZipper,
    /// The default: a surface midway between both faces, in whichever direction the membrane lies,
    /// flat in the slices, too.
    #[default]
    RidgeSurface,
}

/// What a run may be told. The default is right for most.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Options {
    /// How the mid-surface is found.
    pub method: Method,
    /// The labels to extract; `None`: all.
    pub labels: Option<Vec<i64>>,
    /// Number of worker threads; 0: one a core.
    pub threads: usize,
    /// The mesh's edge length to aim at, world units; 0: √2 times the finest spacing.
    pub edge_length: f64,
}

impl Options {
    /// Share of the run within which labels are read and, by the zipper, lines are traced.
    fn tracing(&self) -> f64 {
        match self.method {
            Method::PolylineZipper => 0.45,
            Method::RidgeSurface => 1.0,
        }
    }

    fn check(&self) -> Result<()> {
        if self.edge_length >= 0.0 && self.edge_length.is_finite() {
            Ok(())
        } else {
            Err(Error::EdgeLength(self.edge_length))
        }
    }
}

/// The mid-surface of the labels as a triangle mesh.
///
/// # Errors
/// Where the scalars are no segmentation, none of the labels asked for is there, an option is
/// unusable, memory is refused, or the observer cancels.
pub fn extract(volume: &Volume, options: &Options, observer: &mut dyn Observer) -> Result<Mesh> {
    options.check()?;
    let mut execution = Execution::new(options.threads, observer)?;
    let parts = read_parts(volume, options, &mut execution, options.tracing())?;
    let mut alone = Alone;
    let team = &mut Team::new(&mut alone);
    let found = find_surface(
        &parts,
        &volume.grid,
        (options, Sizes::USUAL),
        team,
        &mut execution,
    )?;
    found.findings.warn(&mut execution);
    execution.finish()?;
    Ok(found.mesh)
}

/// The distinct labels of a volume, ascending; 0 is background.
///
/// # Errors
/// As [`extract`].
pub fn find_labels(
    volume: &Volume,
    options: &Options,
    observer: &mut dyn Observer,
) -> Result<Vec<i64>> {
    let mut execution = Execution::new(options.threads, observer)?;
    execution.stage("Finding labels", 0.0, 1.0, 1)?;
    let voxels = volume.grid.voxel_count()?;
    let scan = reading::runs::scan(volume, voxels, &mut execution, |_| false)?;
    Ok(scan.labels.into_iter().collect())
}

/// Writes distance and ridge field, both in world units, into arrays of the volume's shape
/// (z, y, x). Voxels far from every label stay as they are.
///
/// # Errors
/// As [`extract`].
pub fn ridge_field(
    volume: &Volume,
    options: &Options,
    observer: &mut dyn Observer,
    mut distance: ArrayViewMut3<f32>,
    mut ridge: ArrayViewMut3<f32>,
) -> Result<()> {
    let mut execution = Execution::new(options.threads, observer)?;
    let parts = read_parts(volume, options, &mut execution, 1.0)?;
    let mut fields = Fields {
        distance: distance.view_mut(),
        ridge: ridge.view_mut(),
        first: [0; 3],
    };
    write_fields(&parts, &volume.grid, &mut fields, &mut execution)
}

/// The mid-polylines of every slice.
///
/// # Errors
/// As [`extract`].
pub fn mid_polylines(
    volume: &Volume,
    options: &Options,
    observer: &mut dyn Observer,
) -> Result<Polylines> {
    let mut execution = Execution::new(options.threads, observer)?;
    let parts = read_parts(volume, options, &mut execution, 1.0)?;
    let (polylines, disks) = trace_polylines(&parts, &volume.grid, &mut execution, 1.0)?;
    let findings = Findings {
        disks,
        ..Findings::default()
    };
    findings.warn(&mut execution);
    Ok(polylines)
}

/// Joins the polylines of neighbouring slices to a mesh: that of [`extract`] before it is remeshed,
/// whatever edge length the options name.
///
/// # Errors
/// Where the lines do not lie in parallel slices, memory is refused, or the observer cancels.
pub fn zip_polylines(
    polylines: &Polylines,
    options: &Options,
    observer: &mut dyn Observer,
) -> Result<Mesh> {
    polylines.check()?;
    let mut execution = Execution::new(options.threads, observer)?;
    let mut findings = Findings::default();
    let mesh =
        zipped_surface(polylines, &mut findings, 1.0, &mut execution)?.into_mesh(&mut execution)?;
    findings.warn(&mut execution);
    execution.finish()?;
    Ok(mesh)
}
