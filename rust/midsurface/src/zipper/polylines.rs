//! Stage 5, ridge field → mid-polylines: a line midway through the label, slice by slice.
//!
//! Every slice along z of every part is worked on by itself (MidSurfer, section "Mid-Polyline
//! Extraction"), the first and the last slice too. Each connected component of the slice is traced
//! from its peak; what no line covers, branches, is traced in turn. Where the sheet lies flat in
//! the slices, as at the caps of a closed surface, a component is a disk without a mid-line: it is
//! counted, and the caller says so.

use crate::error::{collected, extend, push, Result};
use crate::execution::Execution;
use crate::fields::bricks::{Batch, Directory};
use crate::fields::interpolation::Sampler;
use crate::fields::ray::Inside;
use crate::fields::thickness::{depth, View};
use crate::grid::{last_voxel, Grid, Vec3};
use crate::reading::components::Part;
use crate::reading::runs::Run;
use crate::zipper::border::normal_near_border;
use crate::zipper::centre::{centre, complete, Which};
use crate::zipper::ends::{ends_on_border, put_on_border, Line};
use crate::zipper::resample::{arc_length, resample};
use crate::zipper::ridge::RidgeField;
use crate::zipper::slice::{Pixel, Point, Slice, COVERED, LINE};
use crate::zipper::trace::{trace, Trace};

/// Distance of neighbouring points on a line, in units of the finest spacing (the paper's √2).
const SPACING: f64 = std::f64::consts::SQRT_2;
/// A component is a disk where its line's squared length is below this share of its area.
const DISK: f64 = 1.3;
/// A component of a smaller area is no disk, units squared of the finest spacing.
const SMALLEST_DISK: f64 = 12.0;
/// How often a region that no line covers is tried from another start.
const ATTEMPTS: usize = 3;
/// Quantiles of the ridge field at which the attempts start, in regions of enough pixels.
const SEEDS: [f64; ATTEMPTS] = [1.0, 0.9, 0.75];
const LEAST_RANKED: usize = 64;
/// A region of fewer pixels is the rim of a covered one.
const SMALLEST_REGION: usize = 4;

/// Polylines in the slices of a volume, all arrays parallel.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Polylines {
    /// World coordinates.
    pub points: Vec<Vec3>,
    /// Local thickness at each point, world units.
    pub thickness: Vec<f32>,
    /// Distance of each point from the border of the volume within its slice, world units, not
    /// negative; infinite where there is no border. Flattening moves no point over the border.
    pub border_distance: Vec<f32>,
    /// The lines, those of a component in the order of their slices.
    pub lines: Vec<Polyline>,
    /// Row-major matrix whose columns are the steps from voxel to voxel along the image's axes,
    /// world units, so that terraces are known as such; all zero where that is unknown.
    pub voxel_steps: [Vec3; 3],
}

impl Polylines {
    /// Appends the lines of others.
    pub(crate) fn append(&mut self, others: Self) -> Result<()> {
        let first = self.points.len();
        self.voxel_steps = others.voxel_steps;
        extend(&mut self.points, others.points)?;
        extend(&mut self.thickness, others.thickness)?;
        extend(&mut self.border_distance, others.border_distance)?;
        let lines = others.lines.into_iter();
        let moved = lines.map(|line| Polyline {
            first: first + line.first,
            ..line
        });
        extend(&mut self.lines, moved)
    }
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

/// The lines of one slice of a part, work units.
#[derive(Default)]
struct SliceLines {
    lines: Vec<Line>,
    disks: usize,
}

/// The lines of all slices of a batch, and the number of disks.
pub(crate) fn polylines(
    batch: &Batch,
    field: &RidgeField,
    grid: &Grid,
    execution: &mut Execution,
) -> Result<(Polylines, usize)> {
    let h = grid.work_spacing();
    let slices = batch.parts.iter().enumerate().flat_map(|(i, part)| {
        let slices = part.runs.chunk_by(|a, b| a.z == b.z);
        slices.map(move |runs| (i, runs))
    });
    let jobs = collected(slices)?;
    let mut polylines = Polylines {
        voxel_steps: grid.voxel_steps(),
        ..Polylines::default()
    };
    let mut disks = 0;
    let mut job = jobs.iter();
    execution.stream(
        &jobs,
        |&(part, runs)| {
            let directory = &batch.directories[part];
            trace_slice(
                PartField {
                    directory,
                    field,
                    h,
                },
                runs,
            )
        },
        |found: Result<SliceLines>| {
            let found = found?;
            disks += found.disks;
            if let Some(&(part, runs)) = job.next() {
                append(&mut polylines, found, &batch.parts[part], runs[0].z, grid)?;
            }
            Ok(())
        },
    )?;
    Ok((polylines, disks))
}

/// The fields of a part.
#[derive(Clone, Copy)]
struct PartField<'a> {
    directory: &'a Directory,
    field: &'a RidgeField,
    h: Vec3,
}

impl<'a> PartField<'a> {
    fn sampler(&self, field: &'a [f32]) -> Sampler<'a> {
        Sampler {
            directory: self.directory,
            field,
            h: self.h,
        }
    }

    /// What a point of a slice sees of the label, where the sheet is known.
    fn view(&self, slice: &Slice, p: Point) -> Option<View> {
        let from = [p[0], p[1], slice.z as f64 * self.h[2]];
        let (normal, _) = slice.sheet(p)?;
        let distance = self.sampler(&self.field.distance);
        let thickness = 2.0 * depth(&distance, from);
        let normal = normal_near_border(&distance, &self.field.sheets, from, normal, thickness);
        let mask = &self.field.mask;
        Some(View::new(&Inside { distance, mask }, from, normal))
    }
}

/// All lines of one slice of a part.
fn trace_slice(part: PartField, runs: &[Run]) -> Result<SliceLines> {
    let z = runs[0].z as usize;
    let mut slice = Slice::new(part.sampler(&part.field.fraction), &part.field.sheets, z)?;
    let mut found = SliceLines::default();
    for (number, pixels) in slice.components(runs)?.into_iter().enumerate() {
        let component = number as u32;
        let is_speck = area(&slice, &pixels) < SMALLEST_DISK;
        let mut regions = vec![(pixels, 0)];
        let mut primary = true;
        while let Some((pixels, attempt)) = regions.pop() {
            let line = trace_region(part, &mut slice, &pixels, component, primary, attempt)?;
            primary &= line.is_none();
            let attempt = if line.is_some() { 0 } else { attempt + 1 };
            if let Some(line) = line {
                found.lines.push(finish(part, &slice, line));
            }
            if attempt < ATTEMPTS {
                let rest = slice.uncovered(&pixels)?.into_iter();
                let rest = rest.filter(|region| region.len() >= SMALLEST_REGION);
                regions.extend(rest.map(|region| (region, attempt)));
            }
        }
        found.disks += usize::from(primary && !is_speck);
    }
    Ok(found)
}

/// Moves a line's points to the middle between both faces, and measures the thickness there.
fn finish(part: PartField, slice: &Slice, mut line: Trace) -> Line {
    let mut views: Vec<Option<View>> = line.points.iter().map(|&p| part.view(slice, p)).collect();
    complete(&mut views);
    let ends = ends_on_border(slice, &line);
    centre(slice, &mut line, &views, Which::All);
    if views.iter().flatten().any(View::at_border) {
        // Far off the middle a point sees the faces of other places than its own.
        for (view, &p) in views.iter_mut().zip(&line.points) {
            if view.as_ref().is_some_and(View::at_border) {
                *view = part.view(slice, slice.clamp(p)).or(view.take());
            }
        }
        complete(&mut views);
        centre(slice, &mut line, &views, Which::AtBorder);
    }
    let known = |i: usize| views[i].as_ref().map(|view| view.thickness);
    // A point at a corner may see no sheet: it takes its neighbour's thickness.
    let nearest = |i: usize| {
        (0..views.len()).find_map(|k| {
            let before = i.checked_sub(k).and_then(known);
            before.or_else(|| (i + k < views.len()).then(|| known(i + k)).flatten())
        })
    };
    let mut line = Line {
        thickness: (0..views.len())
            .map(|i| nearest(i).unwrap_or(0.0))
            .collect(),
        points: line.points,
        closed: line.closed,
    };
    let unit = slice.h()[0].min(slice.h()[1]);
    put_on_border(slice, &mut line, ends, SPACING * unit);
    line
}

/// The line from the peak of a region, `None` where there is none worth keeping. Covers what
/// belongs to the line, or the start of a line that is not kept.
fn trace_region(
    part: PartField,
    slice: &mut Slice,
    pixels: &[Pixel],
    component: u32,
    primary: bool,
    attempt: usize,
) -> Result<Option<Trace>> {
    let unit = slice.h()[0].min(slice.h()[1]);
    let seed = seed(part, slice.z, pixels, attempt)?;
    let start = slice.centre(seed);
    let limit = 4 * pixels.len() + 64;
    let line = trace(slice, start, component, limit)
        .map(|line| (half_widths(slice, &line, component), line))
        .filter(|(widths, line)| {
            let least = if primary { 0.3 } else { 2.0 * SPACING };
            arc_length(line) > least * unit && !is_disk(slice, line, widths, pixels)
        });
    match &line {
        Some((widths, line)) => {
            for &p in &line.points {
                slice.set(slice.pixel(p), LINE);
            }
            cover_line(slice, line, widths, component);
        }
        None => slice.cover(start, 1.5 * unit, component),
    }
    // Whatever the line covers, the region shrinks, so that regions come to an end.
    slice.set(seed.map(|v| v as isize), COVERED);
    Ok(line.and_then(|(_, line)| resample(slice, line, SPACING * unit, slice.z % 2 == 1)))
}

/// Whether the region of a line is a disk: its line is short against what lies beside it.
fn is_disk(slice: &Slice, line: &Trace, widths: &[f64], pixels: &[Pixel]) -> bool {
    let unit = slice.h()[0].min(slice.h()[1]);
    let length = arc_length(line) / unit;
    // Branches do not count.
    let width = 2.0 * widths.iter().sum::<f64>() / widths.len() as f64;
    let area = area(slice, pixels).min(length * width / unit);
    // What ends on the border goes on beyond it: with its mirror image it is twice as long.
    let leaves = ends_on_border(slice, line).iter().any(Option::is_some);
    let share = if leaves { 0.5 * DISK } else { DISK };
    length * length <= share * area && area >= SMALLEST_DISK
}

/// Area of pixels, units squared of the finest spacing.
fn area(slice: &Slice, pixels: &[Pixel]) -> f64 {
    let [x, y, _] = slice.h();
    pixels.len() as f64 * x * y / x.min(y).powi(2)
}

/// Where a region's line starts: at the peak of the ridge field, and where that failed, lower: in a
/// network of sheets the peak is a crossing, which has no direction.
fn seed(part: PartField, z: usize, pixels: &[Pixel], attempt: usize) -> Result<Pixel> {
    let height = |p: &Pixel| {
        let entry = part.directory.entry([p[0], p[1], z]);
        entry.map_or(0.0, |entry| part.field.ridge[entry])
    };
    let mut ranked = collected(pixels.iter().map(|p| (height(p), *p)))?;
    let quantile = if pixels.len() < LEAST_RANKED {
        1.0
    } else {
        SEEDS[attempt.min(ATTEMPTS - 1)]
    };
    let rank = ((ranked.len() - 1) as f64 * quantile) as usize;
    let by_height = |a: &(f32, Pixel), b: &(f32, Pixel)| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1));
    Ok(ranked.select_nth_unstable_by(rank, by_height).1 .1)
}

/// Covers the pixels between both faces of the label along a line. The width is measured across
/// the line, and bounded by its neighbours', so that the line does not cover a branch.
fn cover_line(slice: &mut Slice, line: &Trace, widths: &[f64], component: u32) {
    const WINDOW: usize = 8;
    let unit = slice.h()[0].min(slice.h()[1]);
    let mut near = Vec::with_capacity(2 * WINDOW + 1);
    // A trace's points are 0.7 apart, so that every other one is near enough to all pixels.
    for (i, &p) in line.points.iter().enumerate().step_by(2) {
        near.clear();
        near.extend(&widths[i.saturating_sub(WINDOW)..(i + WINDOW + 1).min(widths.len())]);
        let middle = near.len() / 2;
        let typical = *near.select_nth_unstable_by(middle, f64::total_cmp).1;
        let radius = widths[i].min(1.3 * typical) + 0.75 * unit;
        slice.cover(p, radius, component);
    }
}

/// Half widths of the label at the points of a line.
fn half_widths(slice: &Slice, line: &Trace, component: u32) -> Vec<f64> {
    let width = |i| half_width(slice, line.points[i], line.tangent(i), component);
    (0..line.points.len()).map(width).collect()
}

/// Distance from a point to the farther face of the label, across the line.
fn half_width(slice: &Slice, p: Point, tangent: Point, component: u32) -> f64 {
    let step = 0.5 * slice.h()[0].min(slice.h()[1]);
    let side = |sign: f64| {
        let at = |k: usize| {
            let t = sign * step * k as f64;
            [p[0] - t * tangent[1], p[1] + t * tangent[0]]
        };
        let most = 2 * crate::fields::distance::LARGEST as usize;
        let steps = (1..most).find(|&k| slice.component(slice.pixel(at(k))) != Some(component));
        step * steps.unwrap_or(most) as f64
    };
    side(1.0).max(side(-1.0))
}

/// Moves a slice's lines into world coordinates and appends them.
fn append(
    polylines: &mut Polylines,
    found: SliceLines,
    part: &Part,
    z: u32,
    grid: &Grid,
) -> Result<()> {
    let h = grid.work_spacing();
    let last = last_voxel(grid.dimensions, h);
    let across = |p: &Point, a: usize| p[a].min(last[a] - p[a]);
    for line in found.lines {
        let polyline = Polyline {
            first: polylines.points.len(),
            count: line.points.len(),
            closed: line.closed,
            label: part.label,
            component: part.component,
            slice: grid.extent_start[2] + i64::from(z),
        };
        push(&mut polylines.lines, polyline)?;
        let world = |p: &Point| grid.world([p[0] / h[0], p[1] / h[1], f64::from(z)]);
        extend(&mut polylines.points, line.points.iter().map(world))?;
        let scaled = line.thickness.iter().map(|t| (t * grid.unit()) as f32);
        extend(&mut polylines.thickness, scaled)?;
        let border = |p: &Point| across(p, 0).min(across(p, 1)).max(0.0) * grid.unit();
        let distances = line.points.iter().map(|p| border(p) as f32);
        extend(&mut polylines.border_distance, distances)?;
    }
    Ok(())
}
