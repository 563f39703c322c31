//! The stages of the ridge surface as they are run in one tile.
//!
//! The stages look no farther than so many voxels, so that what comes out in the tile does not depend on
//! what lies beyond its margin. What they take from the whole component is told to them: the numbers of
//! its parts, how triangles are wound, and how full the label is inside (`sheets/scale.rs`), as sums of bricks.
//! There is no surface of ribbons hardly wider than thick (`sheets/crest.rs`): a component that large is none.

use crate::contour;
use crate::contour::creases::cut_creases;
use crate::contour::holes::close_holes;
use crate::contour::rim::{inside, over_inside, smoothed_mask};
use crate::error::{collected, Result};
use crate::execution::Execution;
use crate::fields::bricks::Batch;
use crate::fields::distance;
use crate::fields::label::Label;
use crate::fields::mask::{self, Mask};
use crate::grid::{Grid, Vec3};
use crate::mesh::Mesh;
use crate::midway::beyond::lead_beyond;
use crate::midway::move_midway;
use crate::reading::components::Part;
use crate::remesh::{remesh_some, wanted_edge, Before};
use crate::ridge_surface::{find_sheets, finish, in_world, led_on, trimmed, values};
use crate::sheets::scale::BrickMeans;
use crate::surface::halfedge::Fans;
use crate::surface::manifold::{make_manifold_as_wound, Surface};
use crate::tiles::mosaic::{kept, wanted};
use crate::tiles::seams::used_by;
use crate::tiles::{clipped, VoxelBox};

/// Voxels around a tile within which the label tells its contour.
const CONTOUR_REACH: usize = 64;
/// Voxels around the surface that is moved in which the label is known.
const LABEL_REACH: usize = 16;
/// Where finishing begins by the count of its stages.
pub(crate) const FINISH_BEGINS: f64 = 0.94;

/// A brick, told by its part and place, and what its voxels add up to for [`BrickMeans`].
pub(crate) type BrickSums = (u32, [usize; 3], [f32; 2]);

/// What a stage is told of a component. A point's source is its part among all.
pub(crate) struct Stages<'a> {
    parts: &'a [Part],
    pub grid: &'a Grid,
    pub h: Vec3,
    /// The edge length to aim at, work units.
    pub wanted: f64,
    /// The sums of the component's bricks, ordered by part and place.
    pub sums: Vec<BrickSums>,
}

/// The parts near a tile.
struct Near {
    parts: Vec<Part>,
    /// Their numbers in the component.
    numbers: Vec<u32>,
}

impl Near {
    /// Numbers the sources of a surface among the parts near; the triangles of others go.
    fn to_local(&self, surface: &mut Surface) {
        let local = |part: u32| self.numbers.binary_search(&part).ok();
        let source = &surface.source;
        let triangles = &mut surface.triangles;
        triangles.retain(|t| local(source[t[0] as usize]).is_some());
        for part in &mut surface.source {
            // Points that no triangle is left of may be of any part.
            *part = local(*part).unwrap_or(0) as u32;
        }
    }

    /// Numbers the sources of a surface in the component.
    fn to_component(&self, surface: &mut Surface) {
        let sources = surface.source.iter_mut();
        sources.for_each(|part| *part = self.numbers[*part as usize]);
    }
}

impl<'a> Stages<'a> {
    pub fn new(parts: &'a [Part], grid: &'a Grid, edge_length: f64) -> Self {
        Self {
            parts,
            grid,
            h: grid.work_spacing(),
            wanted: wanted_edge(edge_length, grid),
            sums: Vec::new(),
        }
    }

    fn near(&self, within: &VoxelBox) -> Result<Near> {
        let (parts, numbers) = clipped(self.parts, within)?;
        Ok(Near { parts, numbers })
    }

    /// The contour in and around a tile, not wound yet, and the sums of the bricks around. The stages take
    /// the progress up to `until`.
    pub fn contour(
        &self,
        near: &VoxelBox,
        until: f64,
        execution: &mut Execution,
    ) -> Result<(Surface, Vec<BrickSums>)> {
        let near = self.near(&near.grown(CONTOUR_REACH))?;
        let batch = &Batch::new(&near.parts, self.grid.dimensions)?;
        let passes = distance::PASSES + mask::PASSES + 1;
        execution.stage("Measuring thickness", 0.0, 0.01, passes)?;
        let distance = distance::distance(batch, self.h, execution)?;
        let mask = Mask::new(batch, &distance, execution)?;
        let label = Label {
            batch,
            distance: &distance,
            mask: &mask,
            h: self.h,
        };
        let sheets = find_sheets(&label, execution)?;
        drop(mask);
        execution.stage("Joining sheets", 0.37, until, contour::PASSES)?;
        let mut surface = contour::contour(batch, &sheets, self.h, execution)?;
        let smoothed = smoothed_mask(batch, &distance, self.h, execution)?;
        let inside = inside(batch, &sheets, (&distance, &smoothed), self.h, execution)?;
        let sums = batch.places().map(|(brick, place)| {
            let part = near.numbers[batch.part_of_brick[brick] as usize];
            (part, place, inside.sums()[brick])
        });
        let sums = collected(sums)?;
        near.to_component(&mut surface);
        Ok((surface, sums))
    }

    /// A contour that is wound, cut at the rims, closed and led on beyond the border of the volume.
    pub fn cut(
        &self,
        surface: Surface,
        near: &VoxelBox,
        execution: &mut Execution,
    ) -> Result<Surface> {
        self.with_label(surface, near, execution, |surface, around, execution| {
            let Label { batch, h, .. } = around.label;
            let mut surface = surface.compact()?;
            make_manifold_as_wound(&mut surface, execution)?;
            let fraction = values(batch, &surface, around.fraction, h, execution)?;
            let last = around.label.last();
            let mut surface = trimmed(surface, &fraction, last, execution)?;
            let fans = cut_creases(&around.label, &mut surface, around.fraction, execution)?;
            let label = &around.label;
            let fans = close_holes(label, &mut surface, fans, around.fraction, execution)?;
            lead_beyond(&mut surface, &fans, last)?;
            Ok(surface)
        })
    }

    /// Where the points of a surface go to be midway.
    pub fn moved(
        &self,
        surface: &Surface,
        near: &VoxelBox,
        execution: &mut Execution,
    ) -> Result<Vec<Vec3>> {
        let surface = surface.copied()?;
        let moved = self.with_label(
            surface,
            near,
            execution,
            |mut surface, around, execution| {
                let Label { batch, h, .. } = around.label;
                // Beyond the border of the volume a sheet is as full as on it.
                let mut within = surface.copied()?;
                self.grid.keep_within(&mut within.points);
                let fraction = values(batch, &within, around.fraction, h, execution)?;
                drop(within);
                let fans = Fans::new(&surface.triangles, surface.points.len())?;
                move_midway(&around.label, &mut surface, &fraction, &fans, execution)?;
                Ok(surface)
            },
        );
        moved.map(|surface| surface.points)
    }

    /// A surface cut at the border of the volume, and led on to where sheets meet.
    pub fn led_on(
        &self,
        surface: Surface,
        near: &VoxelBox,
        execution: &mut Execution,
    ) -> Result<Surface> {
        self.with_label(surface, near, execution, |surface, around, execution| {
            let mut surface = led_on(&around.label, surface, around.fraction, execution)?;
            self.grid.keep_within(&mut surface.points);
            Ok(surface)
        })
    }

    /// What `work` makes of a surface that lies in a box and what is known of the label there.
    fn with_label(
        &self,
        mut surface: Surface,
        near: &VoxelBox,
        execution: &mut Execution,
        work: impl Fn(Surface, &Around, &mut Execution) -> Result<Surface>,
    ) -> Result<Surface> {
        let near = self.near(&near.grown(LABEL_REACH))?;
        let batch = &Batch::new(&near.parts, self.grid.dimensions)?;
        let distance = distance::distance(batch, self.h, execution)?;
        let sums_of = |(brick, place): (usize, [usize; 3])| {
            let part = near.numbers[batch.part_of_brick[brick] as usize];
            let sums = &self.sums;
            let found = sums.binary_search_by_key(&(part, place), |&(part, at, _)| (part, at));
            found.map_or([0.0; 2], |at| sums[at].2)
        };
        let inside = BrickMeans::of_sums(collected(batch.places().map(sums_of))?);
        let smoothed = smoothed_mask(batch, &distance, self.h, execution)?;
        let around = Around {
            fraction: &over_inside(batch, smoothed, &inside, execution)?,
            label: Label {
                batch,
                distance: &distance,
                mask: &Mask::new(batch, &distance, execution)?,
                h: self.h,
            },
        };
        near.to_local(&mut surface);
        let mut surface = work(surface, &around, execution)?;
        near.to_component(&mut surface);
        Ok(surface)
    }

    /// The own triangles of a surface, remeshed; the others around stay as they are.
    pub fn remeshed(
        &self,
        around: &Surface,
        is_own: impl Fn(Vec3) -> bool + Sync,
        before: Before,
        execution: &mut Execution,
    ) -> Result<Surface> {
        let Surface {
            points,
            triangles,
            source,
        } = around;
        let own = wanted(around, is_own, execution)?;
        let how = (self.wanted, before);
        let remeshed = remesh_some((points, triangles), |t| own[t], how, execution)?;
        let part_of = |origin: u32| source[triangles[origin as usize][0] as usize];
        let mut surface = Surface {
            source: collected(remeshed.origin.iter().map(|o| part_of(o.triangle)))?,
            points: remeshed.points,
            triangles: remeshed.triangles,
        };
        self.grid.keep_within(&mut surface.points);
        Ok(surface)
    }

    /// A surface in a box without terraces and self-intersections, and as a mesh; of this the own triangles
    /// and those beside them, and which are own.
    pub fn finished(
        &self,
        mut surface: Surface,
        near: &VoxelBox,
        is_own: impl Fn(Vec3) -> bool + Sync,
        execution: &mut Execution,
    ) -> Result<(Surface, Mesh, Vec<bool>)> {
        let near = self.near(near)?;
        near.to_local(&mut surface);
        if surface.triangles.is_empty() {
            return Ok(Default::default());
        }
        let batch = &Batch::new(&near.parts, self.grid.dimensions)?;
        let distance = distance::distance(batch, self.h, execution)?;
        let label = Label {
            batch,
            distance: &distance,
            mask: &Mask::new(batch, &distance, execution)?,
            h: self.h,
        };
        let surface = surface.compact()?;
        let (found, _) = finish(&label, surface, self.grid, self.wanted, execution)?;
        // Normals of own points are those of all triangles around them.
        let own = wanted(&found, is_own, execution)?;
        let is_used = used_by(&found, |t| own[t])?;
        let triangles = found.triangles.iter();
        let beside = collected(triangles.map(|t| t.iter().any(|&p| is_used[p as usize])))?;
        let found = kept(&found, &beside)?;
        let stays = own.into_iter().zip(beside).filter(|(_, stays)| *stays);
        let is_own = collected(stays.map(|(own, _)| own))?;
        let mut of_component = found.copied()?;
        near.to_component(&mut of_component);
        let fans = Fans::new(&found.triangles, found.points.len())?;
        let mesh = in_world(&label, self.grid, (found, fans), execution)?;
        Ok((of_component, mesh, is_own))
    }
}

/// What is known of the label around a tile.
struct Around<'a> {
    /// The sheet fraction at the voxels.
    fraction: &'a [f32],
    label: Label<'a>,
}
