//! The arrays polylines are passed in, checked before they become the core's polylines.

use midsurface::{Polyline, Polylines};

use crate::arguments::{collected, optional_slice, slice, value};
use crate::error::midsurface_error;

/// The arrays of polylines: a view, borrowed, used both to pass polylines in and to read them
/// out. Line l joins the points connectivity[offsets[l]] to connectivity[offsets[l + 1] - 1] in
/// this order.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct midsurface_polyline_arrays {
    /// World coordinates, x y z: 3 * point_count values, finite.
    pub points: *const f64,
    /// Number of points.
    pub point_count: usize,
    /// Local thickness at the points, in the unit of the coordinates, not negative: point_count
    /// values. May be NULL on input: all 0.
    pub thickness: *const f32,
    /// Distance of the points from the border of the volume within their slice, in the unit of the
    /// coordinates, not negative: point_count values. Zipping moves no point over that border. May
    /// be NULL on input: there is no border, as with infinity.
    pub border_distance: *const f32,
    /// Where each line begins in connectivity, and last its length: line_count + 1 values from 0
    /// to connectivity_length, ascending. May be NULL on input where line_count is 0.
    pub offsets: *const i64,
    /// Number of lines.
    pub line_count: usize,
    /// Point indices, 0 to point_count - 1. A closed line repeats its first index at its end.
    pub connectivity: *const i64,
    /// Number of values in connectivity.
    pub connectivity_length: usize,
    /// Label of each line: line_count values. May be NULL on input: all 1.
    pub labels: *const i64,
    /// Component of each line, as in midsurface_mesh_arrays: line_count values from 0 to
    /// 2^32 - 1. May be NULL on input: all 0.
    pub components: *const i64,
    /// Slice of each line, its index along z in the image's extent: line_count values. Lines are
    /// joined within a slice and to the slices next to it.
    pub slices: *const i64,
    /// Row-major matrix whose columns are the steps from voxel to voxel along the volume's axes, in
    /// the unit of the coordinates: 9 values, finite. May be NULL on input, and 0: unknown, and
    /// terraces of voxels are flattened less.
    pub voxel_steps: *const f64,
}

impl midsurface_polyline_arrays {
    pub(crate) const EMPTY: Self = Self {
        points: std::ptr::null(),
        point_count: 0,
        thickness: std::ptr::null(),
        border_distance: std::ptr::null(),
        offsets: std::ptr::null(),
        line_count: 0,
        connectivity: std::ptr::null(),
        connectivity_length: 0,
        labels: std::ptr::null(),
        components: std::ptr::null(),
        slices: std::ptr::null(),
        voxel_steps: std::ptr::null(),
    };
}

/// The arrays as slices, the lengths as the view says.
struct Slices<'a> {
    points: &'a [[f64; 3]],
    thickness: Option<&'a [f32]>,
    border_distance: Option<&'a [f32]>,
    offsets: &'a [i64],
    connectivity: &'a [i64],
    labels: Option<&'a [i64]>,
    components: Option<&'a [i64]>,
    slices: &'a [i64],
    voxel_steps: Option<&'a [[f64; 3]]>,
}

/// The core's polylines, copied from the caller's arrays.
///
/// # Safety
/// `arrays` is null or as the header describes.
pub(crate) unsafe fn read(
    arrays: *const midsurface_polyline_arrays,
) -> Result<Polylines, midsurface_error> {
    // SAFETY: the same contract.
    unsafe { Slices::borrow(&value(arrays, "arrays")?) }?.polylines()
}

impl Slices<'_> {
    /// # Safety
    /// As for [`read`].
    unsafe fn borrow(arrays: &midsurface_polyline_arrays) -> Result<Self, midsurface_error> {
        let lines = arrays.line_count;
        let offset_count = match (lines, arrays.offsets.is_null()) {
            (0, true) => 0,
            _ => lines.saturating_add(1),
        };
        let points = arrays.point_count;
        // SAFETY: as the header describes; three doubles are aligned as one.
        unsafe {
            Ok(Self {
                points: slice(arrays.points.cast(), points, "arrays.points")?,
                thickness: optional_slice(arrays.thickness, points, "arrays.thickness")?,
                border_distance: optional_slice(
                    arrays.border_distance,
                    points,
                    "arrays.border_distance",
                )?,
                offsets: slice(arrays.offsets, offset_count, "arrays.offsets")?,
                connectivity: slice(
                    arrays.connectivity,
                    arrays.connectivity_length,
                    "arrays.connectivity",
                )?,
                labels: optional_slice(arrays.labels, lines, "arrays.labels")?,
                components: optional_slice(arrays.components, lines, "arrays.components")?,
                slices: slice(arrays.slices, lines, "arrays.slices")?,
                voxel_steps: optional_slice(arrays.voxel_steps.cast(), 3, "arrays.voxel_steps")?,
            })
        }
    }

    fn polylines(&self) -> Result<Polylines, midsurface_error> {
        self.check_offsets()?;
        self.check_indices()?;
        self.check_values()?;
        let lines = 0..self.slices.len();
        let mut end = 0;
        let polyline = |line: usize| {
            let first = end;
            end += self.corners(line).len();
            Polyline {
                first,
                count: end - first,
                closed: is_closed(self.entries(line)),
                label: self.labels.map_or(1, |labels| labels[line]),
                component: self
                    .components
                    .map_or(0, |components| components[line] as u32),
                slice: self.slices[line],
            }
        };
        let polylines = collected(lines.len(), lines.clone().map(polyline))?;
        let points = || {
            lines
                .clone()
                .flat_map(|line| self.corners(line))
                .map(|&i| i as usize)
        };
        let thickness = |index| self.thickness.map_or(0.0, |values: &[f32]| values[index]);
        let border = |index| {
            self.border_distance
                .map_or(f32::INFINITY, |values: &[f32]| values[index])
        };
        Ok(Polylines {
            points: collected(end, points().map(|index| self.points[index]))?,
            thickness: collected(end, points().map(thickness))?,
            border_distance: collected(end, points().map(border))?,
            lines: polylines,
            voxel_steps: match self.voxel_steps {
                Some(&[x, y, z]) => [x, y, z],
                _ => [[0.0; 3]; 3],
            },
        })
    }

    /// What connectivity says about a line.
    fn entries(&self, line: usize) -> &[i64] {
        &self.connectivity[self.offsets[line] as usize..self.offsets[line + 1] as usize]
    }

    /// The points of a line, that which closes it counted once.
    fn corners(&self, line: usize) -> &[i64] {
        let entries = self.entries(line);
        &entries[..entries.len() - usize::from(is_closed(entries))]
    }

    fn check_offsets(&self) -> Result<(), midsurface_error> {
        let length = self.connectivity.len();
        let (first, last) = match self.offsets {
            [] => (0, 0),
            offsets => (offsets[0], offsets[offsets.len() - 1]),
        };
        if first != 0 {
            return Err(midsurface_error::invalid(format!(
                "`arrays.offsets` starts at {first}, but must start at 0"
            )));
        }
        if usize::try_from(last) != Ok(length) {
            return Err(midsurface_error::invalid(format!(
                "`arrays.offsets` ends at {last}, but `arrays.connectivity_length` is {length}"
            )));
        }
        match self.offsets.windows(2).position(|pair| pair[0] >= pair[1]) {
            Some(line) => Err(midsurface_error::invalid(format!(
                "line {line} has no points: `arrays.offsets` must ascend"
            ))),
            None => Ok(()),
        }
    }

    fn check_indices(&self) -> Result<(), midsurface_error> {
        let count = self.points.len();
        let inside = |&index: &i64| usize::try_from(index).is_ok_and(|index| index < count);
        if let Some(at) = self.connectivity.iter().position(|index| !inside(index)) {
            return Err(midsurface_error::invalid(format!(
                "`arrays.connectivity` holds {} at {at}, but there are {count} points",
                self.connectivity[at]
            )));
        }
        let tiny = |&line: &usize| is_closed(self.entries(line)) && self.corners(line).len() < 3;
        match (0..self.slices.len()).find(tiny) {
            Some(line) => Err(midsurface_error::invalid(format!(
                "line {line} is closed, but has fewer than 3 points"
            ))),
            None => Ok(()),
        }
    }

    fn check_values(&self) -> Result<(), midsurface_error> {
        let finite = |point: &[f64; 3]| point.iter().all(|value| value.is_finite());
        if let Some(point) = self.points.iter().position(|point| !finite(point)) {
            return Err(midsurface_error::invalid(format!(
                "point {point} has coordinates {:?}, which are not finite",
                self.points[point]
            )));
        }
        let thickness = self.thickness.unwrap_or_default();
        let usable = |value: &f32| value.is_finite() && *value >= 0.0;
        if let Some(point) = thickness.iter().position(|value| !usable(value)) {
            return Err(midsurface_error::invalid(format!(
                "point {point} has a thickness of {}, which is no length",
                thickness[point]
            )));
        }
        let distances = self.border_distance.unwrap_or_default();
        let unusable = |distance: &f32| distance.is_nan() || *distance < 0.0;
        if let Some(point) = distances.iter().position(unusable) {
            return Err(midsurface_error::invalid(format!(
                "point {point} is said to be {} from the border, which is no length",
                distances[point]
            )));
        }
        let components = self.components.unwrap_or_default();
        match components
            .iter()
            .find(|&&component| u32::try_from(component).is_err())
        {
            Some(component) => Err(midsurface_error::invalid(format!(
                "`arrays.components` holds {component}, but components are numbered from 0 to {}",
                u32::MAX
            ))),
            None => Ok(()),
        }
    }
}

/// A closed line names its first point once more at its end.
fn is_closed(entries: &[i64]) -> bool {
    entries.len() > 1 && entries.first() == entries.last()
}
