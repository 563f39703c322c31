//! The method "ridge surface": the mid-surface in any orientation.
//!
//! Batch by batch: how thick the label is (`sheets/scale.rs`), its profile under a Gaussian as wide
//! (`sheets/profile.rs`), the sheets at its crest (`sheets/crest.rs`, `lag.rs`) and where a border of the
//! volume cuts that off (`one_face.rs`), how they bend (`bending.rs`) and on to beyond the rims
//! (`extension.rs`); a surface through them (`contour`), wound the same way (`surface/manifold.rs`), cut at
//! the rims (`contour/rim.rs`, `trim.rs`), rid of scraps (`scraps.rs`) and slivers (`weld.rs`) and creases
//! where sheets meet (`creases.rs`), closed where it has holes within the label (`holes.rs`); led on beyond
//! the border of the volume (`midway/beyond.rs`), moved midway between both faces (`midway`, `look.rs`),
//! made fair where these are not seen (`fairing.rs`), cut at the border, its rims made smooth
//! (`rim_smoothing.rs`), led on to where sheets meet (`reach.rs`); remeshed (`remesh`); rid of terraces
//! (`finish/terraces.rs`), moved a last little step (`midway`), rid of sharp triangles (`finish/sharp.rs`)
//! and self-intersections (`self_intersections.rs`). How much of the progress a stage is given is how long
//! it took on the membranes of real cells.

use crate::contour;
use crate::contour::creases::{self, cut_creases};
use crate::contour::holes::{self, close_holes};
use crate::contour::rim::{self, sheet_fraction};
use crate::contour::scraps::drop_scraps;
use crate::contour::trim::trim;
use crate::contour::weld::{weld, weld_at_border};
use crate::error::{collected, push, zeros, Result};
use crate::execution::Execution;
use crate::fields::bricks::Batch;
use crate::fields::distance;
use crate::fields::interpolation::Sampler;
use crate::fields::label::Label;
use crate::fields::mask::{self, Mask};
use crate::finish::lattice::LatticePlane;
use crate::finish::self_intersections::{self, remove_self_intersections};
use crate::finish::sharp::{self, widen_all};
use crate::finish::terraces::{
    flatten_terraces, Filters, LineOfPoint, LowPass, OnBoundary, STRONG,
};
use crate::grid::{last_voxel, on_border, Grid, Vec3};
use crate::mesh::{drop_degenerate, turn_outward, Mesh};
use crate::midway::beyond::{cut_at_border, lead_beyond};
use crate::midway::reach::{self, reach};
use crate::midway::rim_smoothing::{self, smooth_rims};
use crate::midway::{self, move_closer, move_midway};
use crate::reading::components::Part;
use crate::remesh::{remesh, wanted_edge, Before};
use crate::sheets::bending;
use crate::sheets::crest::{self, core_sheets};
use crate::sheets::extension;
use crate::sheets::one_face::{self, add_cut_sheets};
use crate::sheets::profile::Profile;
use crate::sheets::scale::{self, HalfThickness};
use crate::sheets::settle::settle;
use crate::sheets::sheet::Sheet;
use crate::surface::halfedge::Fans;
use crate::surface::manifold::{self, make_manifold, Surface};
use crate::surface::normals::{normals, NORMAL_PASSES};

/// How far offsets are followed, in the coarsest spacing.
const FARTHEST: f64 = 2.0;
/// Times that neighbouring sheets settle.
const SETTLINGS: usize = 3;
/// Rings of voxels that sheets are extended by, at most.
const RINGS: u8 = 12;
/// The filters that flatten terraces: shorter waves than for lines, since midway points have fewer
/// terraces, and gently, since membranes have bends of their own, but for where terraces are long: whether
/// they are is told from normals averaged over one of them.
const FILTERS: Filters = Filters {
    usual: LowPass {
        passband: 0.1,
        degree: 7,
    },
    stronger: Some(STRONG),
    normal_rounds: 8,
};
/// The lattice planes that count: terraces along others are lower. Nearness grows from 11°, where
/// terraces are five voxels long, to 6° and ten.
const LATTICE: [LatticePlane; 3] = [
    lattice_plane([1.0, 0.0, 0.0]),
    lattice_plane([0.0, 1.0, 0.0]),
    lattice_plane([0.0, 0.0, 1.0]),
];
/// Points handed to a worker at a time.
const PIECE: usize = 1024;

const fn lattice_plane(normal: Vec3) -> LatticePlane {
    LatticePlane {
        normal,
        near: [0.98, 0.995],
        most_off: f64::INFINITY,
    }
}

/// The surfaces of parts that make up whole components. Edges are `edge_length` world units long, 0:
/// the default.
pub(crate) fn ridge_surface(
    parts: &[Part],
    grid: &Grid,
    edge_length: f64,
    execution: &mut Execution,
) -> Result<Mesh> {
    let h = grid.work_spacing();
    execution.stage(
        "Measuring thickness",
        0.0,
        0.01,
        distance::PASSES + mask::PASSES + scale::PASSES,
    )?;
    let batch = &Batch::new(parts, grid.dimensions)?;
    let distance = distance::distance(batch, h, execution)?;
    let mask = Mask::new(batch, &distance, execution)?;
    let label = Label {
        batch,
        distance: &distance,
        mask: &mask,
        h,
    };
    let sheets = find_sheets(&label, execution)?;
    let (surface, fraction) = cut_surface(batch, sheets, &distance, grid, execution)?;
    let passes = creases::PASSES
        + holes::PASSES
        + 2
        + midway::PASSES
        + rim_smoothing::PASSES
        + reach::PASSES;
    execution.stage("Moving midway", 0.49, 0.65, passes)?;
    let mut surface = moved_midway(&label, surface, &fraction, execution)?;
    turn_outward(&surface.points, &mut surface.triangles)?;
    execution.stage("Remeshing", 0.65, 0.94, 1)?;
    let wanted = wanted_edge(edge_length, grid);
    let mut found = remeshed(surface, wanted, execution)?;
    grid.keep_within(&mut found.points);
    let (found, fans) = finish(&label, found, grid, wanted, execution)?;
    in_world(&label, grid, (found, fans), execution)
}

/// The surface in new triangles; each point's part stays its source.
fn remeshed(surface: Surface, wanted: f64, execution: &mut Execution) -> Result<Surface> {
    let remeshed = remesh(
        &surface.points,
        &surface.triangles,
        (wanted, Before::Any),
        execution,
    )?;
    let part_of = |origin: u32| {
        let corner = surface.triangles[origin as usize][0];
        surface.source[corner as usize]
    };
    Ok(Surface {
        source: collected(remeshed.origin.iter().map(|o| part_of(o.triangle)))?,
        points: remeshed.points,
        triangles: remeshed.triangles,
    })
}

/// Rids a remeshed surface of terraces and self-intersections, and moves its points a little closer
/// to the middle.
pub(crate) fn finish(
    label: &Label,
    mut found: Surface,
    grid: &Grid,
    wanted: f64,
    execution: &mut Execution,
) -> Result<(Surface, Fans)> {
    let passes = 1
        + 3 * NORMAL_PASSES
        + FILTERS.passes()
        + midway::CLOSER_PASSES
        + sharp::PASSES
        + self_intersections::PASSES;
    execution.stage("Flattening terraces", 0.94, 1.0, passes)?;
    drop_degenerate(&mut found, grid.in_mesh(), execution)?;
    let mut found = found.compact()?;
    let fans = Fans::new(&found.triangles, found.points.len())?;
    flatten(&mut found, &fans, (wanted, grid), execution)?;
    let rough = normals(&found.points, &found.triangles, &fans, execution)?;
    move_closer(label, &mut found, &rough, execution)?;
    let last = label.last();
    widen_all(&mut found, &fans, last, execution)?;
    let component = |part: u32| label.batch.parts[part as usize].component;
    let fans = remove_self_intersections(&mut found, fans, &component, (wanted, last), execution)?;
    grid.keep_within(&mut found.points);
    if !drop_degenerate(&mut found, grid.in_mesh(), execution)? {
        return Ok((found, fans));
    }
    let found = found.compact()?;
    let fans = Fans::new(&found.triangles, found.points.len())?;
    Ok((found, fans))
}

/// Removes the terraces of sheets nearly parallel to a lattice plane; rims move along their normals,
/// too, but on the border of the volume only within it.
fn flatten(
    surface: &mut Surface,
    fans: &Fans,
    (edge, grid): (f64, &Grid),
    execution: &mut Execution,
) -> Result<()> {
    let h = grid.work_spacing();
    let last = last_voxel(grid.dimensions, h);
    let point = |p: &Vec3| {
        let on_border = on_border(*p, last);
        let axis = |of: bool| on_border.map(|on| f64::from(u8::from(on == of)));
        let on_boundary = match on_border.iter().filter(|on| **on).count() {
            0 => OnBoundary::Freely,
            1 => OnBoundary::Within(axis(true)),
            2 => OnBoundary::Along(axis(false)),
            _ => OnBoundary::Stays,
        };
        LineOfPoint {
            edge,
            on_boundary,
            room: f64::INFINITY,
            at_end: false,
        }
    };
    let points = collected(surface.points.iter().map(point))?;
    let normals = normals(&surface.points, &surface.triangles, fans, execution)?;
    flatten_terraces(
        &mut surface.points,
        (&surface.triangles, fans),
        &normals,
        &points,
        (FILTERS.on_spacing(h), &LATTICE),
        execution,
    )
}

/// The sheets of a batch, from the profile's crest to beyond the rims.
pub(crate) fn find_sheets(label: &Label, execution: &mut Execution) -> Result<Vec<Sheet>> {
    let Label {
        batch, distance, h, ..
    } = *label;
    let half_thickness = HalfThickness::new(batch, distance, execution)?;
    execution.stage("Smoothing labels", 0.01, 0.04, 1)?;
    let profile = Profile::new(batch, distance, half_thickness, h, execution)?;
    let passes = crest::PASSES + one_face::PASSES;
    execution.stage("Finding sheets", 0.04, 0.21, passes)?;
    let far = FARTHEST * h.iter().copied().fold(1.0, f64::max);
    let farthest = far as f32;
    let mut sheets = core_sheets(batch, profile, distance, farthest, h, execution)?;
    add_cut_sheets(label, far, &mut sheets, execution)?;
    execution.stage(
        "Extending sheets",
        0.21,
        0.28,
        bending::PASSES + 1 + usize::from(RINGS),
    )?;
    extension::extend(batch, distance, RINGS, farthest, h, &mut sheets, execution)?;
    execution.stage("Settling sheets", 0.28, 0.37, SETTLINGS)?;
    settle(batch, &mut sheets, SETTLINGS, h, execution)?;
    Ok(sheets)
}

/// The contour of the batch's sheets, cut at the rims, with each point's part as its source; and the
/// sheet fraction at the voxels.
fn cut_surface(
    batch: &Batch,
    sheets: Vec<Sheet>,
    distance: &[f32],
    grid: &Grid,
    execution: &mut Execution,
) -> Result<(Surface, Vec<f32>)> {
    let h = grid.work_spacing();
    let passes = contour::PASSES + manifold::PASSES;
    execution.stage("Joining sheets", 0.37, 0.45, passes)?;
    let mut surface = contour::contour(batch, &sheets, h, execution)?;
    make_manifold(&mut surface, execution)?;
    execution.stage("Trimming at rims", 0.45, 0.49, 2 + rim::PASSES)?;
    let fraction = sheet_fraction(batch, &sheets, distance, h, execution)?;
    drop(sheets);
    let at_points = values(batch, &surface, &fraction, h, execution)?;
    let surface = trimmed(
        surface,
        &at_points,
        last_voxel(grid.dimensions, h),
        execution,
    )?;
    Ok((surface, fraction))
}

/// A manifold cut at the rims, without scraps and slivers; `fraction` is the sheet fraction at its points.
pub(crate) fn trimmed(
    mut surface: Surface,
    fraction: &[f64],
    last: Vec3,
    execution: &mut Execution,
) -> Result<Surface> {
    trim(&mut surface, fraction, last)?;
    drop_scraps(&mut surface, last)?;
    weld(&mut surface, execution)?;
    execution.pass_done()?;
    surface.compact()
}

/// Closes a surface's false holes, moves it midway, up to the border of the volume, and leads it on to
/// where sheets meet; `field` is the sheet fraction at the voxels.
fn moved_midway(
    label: &Label,
    mut surface: Surface,
    field: &[f32],
    execution: &mut Execution,
) -> Result<Surface> {
    let mut fans = cut_creases(label, &mut surface, field, execution)?;
    fans = close_holes(label, &mut surface, fans, field, execution)?;
    let mut fraction = values(label.batch, &surface, field, label.h, execution)?;
    for from in lead_beyond(&mut surface, &fans, label.last())? {
        let of_point = fraction[from as usize];
        push(&mut fraction, of_point)?;
    }
    fans = Fans::new(&surface.triangles, surface.points.len())?;
    move_midway(label, &mut surface, &fraction, &fans, execution)?;
    led_on(label, surface, field, execution)
}

/// A surface that is midway, cut at the border of the volume and led on to where sheets meet.
pub(crate) fn led_on(
    label: &Label,
    mut surface: Surface,
    field: &[f32],
    execution: &mut Execution,
) -> Result<Surface> {
    cut_at_border(&mut surface, label.last())?;
    weld_at_border(&mut surface, label.last(), execution)?;
    let mut surface = surface.compact()?;
    let fraction = values(label.batch, &surface, field, label.h, execution)?;
    let fans = Fans::new(&surface.triangles, surface.points.len())?;
    smooth_rims(&mut surface, &fraction, &fans, label.last(), execution)?;
    reach(label, &mut surface, &fraction, &fans, execution)?;
    Ok(surface)
}

/// The value of a field at every point of a surface, whose points have their parts as sources.
pub(crate) fn values(
    batch: &Batch,
    surface: &Surface,
    field: &[f32],
    h: Vec3,
    execution: &mut Execution,
) -> Result<Vec<f64>> {
    let mut values = zeros(surface.points.len())?;
    execution.fill(&mut values, PIECE, |piece, out| {
        for (i, out) in out.iter_mut().enumerate() {
            let p = PIECE * piece + i;
            let directory = &batch.directories[surface.source[p] as usize];
            let sampler = Sampler {
                directory,
                field,
                h,
            };
            *out = sampler.linear(surface.points[p]);
        }
    })?;
    Ok(values)
}

/// A finished surface as a mesh in world coordinates; `source` is the part of each point.
pub(crate) fn in_world(
    label: &Label,
    grid: &Grid,
    (found, fans): (Surface, Fans),
    execution: &mut Execution,
) -> Result<Mesh> {
    let normals = normals(&found.points, &found.triangles, &fans, execution)?;
    let mut thickness: Vec<f32> = zeros(found.points.len())?;
    execution.fill(&mut thickness, PIECE, |piece, out| {
        for (i, out) in out.iter_mut().enumerate() {
            let p = PIECE * piece + i;
            let view = label.view(found.source[p], found.points[p], normals[p]);
            *out = (view.thickness * grid.unit()) as f32;
        }
    })?;
    let mirrored = grid.is_mirrored();
    // Outward stays outward in a mirror only if the corners change places.
    let triangles = found.triangles.iter();
    let triangles = triangles.map(|&[a, b, c]| if mirrored { [a, c, b] } else { [a, b, c] });
    let of_triangles = || {
        let sources = found.triangles.iter().map(|t| found.source[t[0] as usize]);
        sources.map(|part| &label.batch.parts[part as usize])
    };
    let to_world = grid.work_to_world();
    let points = found.points.iter().copied().map(to_world);
    let directions = normals.iter().map(|n| grid.direction_of(*n));
    Ok(Mesh {
        points: collected(points.map(|p| p.map(|v| v as f32)))?,
        triangles: collected(triangles)?,
        normals: collected(directions.map(|n| n.map(|v| v as f32)))?,
        thickness,
        labels: collected(of_triangles().map(|part| part.label))?,
        components: collected(of_triangles().map(|part| part.component))?,
    })
}
