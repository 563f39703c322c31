//! Mid-surfaces of thin labelled slabs.
#![forbid(unsafe_code)]

mod error;
mod execution;
mod grid;
mod mesh;
mod polylines;
mod volume;

pub use error::{Error, Result};
pub use execution::{Observer, Quiet};
pub use grid::{Grid, Vec3};
pub use mesh::Mesh;
use ndarray::ArrayViewMut3;
pub use polylines::{Polyline, Polylines};
pub use volume::{Label, Scalars, Volume};

/// How the mid-surface is found.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Method {
    /// The paper's method: a line in every slice along z, neighbouring lines zipped together.
    #[default]
    PolylineZipper,
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
}

/// The distinct labels of a volume, ascending, background left out.
pub fn find_labels(_volume: &Volume, _options: &Options, _observer: &mut dyn Observer) -> Result<Vec<i64>> {
    Ok(Vec::new())
}

/// Distance and ridge field, written into the caller's arrays of the volume's shape.
pub fn ridge_field(
    _volume: &Volume,
    _options: &Options,
    _observer: &mut dyn Observer,
    _distance: ArrayViewMut3<f32>,
    _ridge: ArrayViewMut3<f32>,
) -> Result<()> {
    Ok(())
}

/// The mid-polylines of every slice.
pub fn mid_polylines(_volume: &Volume, _options: &Options, _observer: &mut dyn Observer) -> Result<Polylines> {
    Ok(Polylines::default())
}

/// Joins the polylines of neighbouring slices to a mesh.
pub fn zip_polylines(_polylines: &Polylines, _options: &Options, _observer: &mut dyn Observer) -> Result<Mesh> {
    Ok(Mesh::default())
}

/// The mid-surface.
pub fn extract(volume: &Volume, options: &Options, observer: &mut dyn Observer) -> Result<Mesh> {
    zip_polylines(&mid_polylines(volume, options, observer)?, options, observer)
}
