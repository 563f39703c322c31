//! Mid-polylines.

use crate::grid::Vec3;

/// Polylines in the slices of a volume, all arrays parallel.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Polylines {
    /// World coordinates.
    pub points: Vec<Vec3>,
    /// Local thickness at each point, world units.
    pub thickness: Vec<f32>,
    /// The lines.
    pub lines: Vec<Polyline>,
}

/// One line: `points[first .. first + count]`, joined in this order.
#[derive(Debug, Clone, PartialEq)]
pub struct Polyline {
    /// Index of the first point.
    pub first: usize,
    /// Number of points, each counted once in a closed line too.
    pub count: usize,
    /// Whether the last point is joined to the first.
    pub closed: bool,
    /// The label the line belongs to.
    pub label: i64,
    /// The connected component of the label, numbered as in [`crate::Mesh::components`].
    pub component: u32,
    /// Index of the slice along z, in the image's extent.
    pub slice: i64,
}
