//! The ridge surface of a component that is larger than what is worked on at once, tile by tile.
//!
//! A step makes the piece of a tile from what lies in the tile and around it, as far as its stages
//! look; between two steps the tiles only need of each other what lies there (`mosaic.rs`):
//!
//! | step | from → to |
//! | --- | --- |
//! | contour | the label → the sheets' contour, not wound yet, and how full the label is inside |
//! | winding | contours → contours that are wound the same way across all seams (`seams.rs`) |
//! | midway | contours → surface cut at the rims, closed, moved midway and led on |
//! | remesh | surface → new triangles up to the seams; then, in tiles that are shifted, across these |
//! | finish | triangles → without terraces and self-intersections, as a mesh |
//!
//! What two tiles make of the place where they meet is the same to the bit, since the margins are as
//! wide as the stages' support; and where that fails, which the seams tell, there is no surface in
//! tiles, and the component is worked on as a whole. Tiles are worked on one after the other, and are
//! dealt to the processes, which all call this at once, by what there is in them.

use std::cmp::Reverse;
use std::collections::BTreeSet;

use rayon::prelude::*;

use crate::error::{collected, extend, filled, push, zeros, Error, Result};
use crate::execution::Execution;
use crate::grid::{Grid, Vec3};
use crate::processes::exchange::Team;
use crate::reading::components::Part;
use crate::remesh::Before;
use crate::surface::manifold::Surface;
use crate::tiles::mosaic::{
    centre, chosen, gathered, is_within, kept, number, received, wanted, Corners, Piece,
};
use crate::tiles::seams::{agree, moved_alike, Patches, Point};
use crate::tiles::tile::{BrickSums, Stages, FINISH_BEGINS};
use crate::tiles::tiled_mesh::{assembled, TileMesh};
use crate::tiles::{tiles, Place, Tile, Tiling, VoxelBox};

/// Voxels around a tile from which a contour comes that is cut and closed, moved midway, and led on.
const CUT_REACH: usize = 48;
const MOVE_REACH: usize = 48;
const LEAD_REACH: usize = 48;
/// Edge lengths from a seam within which triangles are remeshed across it, and as many around them are
/// looked at.
const ACROSS: f64 = 8.0;
/// Edge lengths around a tile from which its finished mesh comes: the rings of points that the low-pass
/// looks over and those for normals, rims and what they touch.
const FINISH_REACH: f64 = 68.0;
/// Shifts of the grid of tiles in which the mesh is remeshed, in sides: across the seams of those before.
const SHIFTS: [f64; 3] = [0.0, 0.5, 0.25];

/// Shares of the progress at which the steps end.
const CONTOUR_ENDS: f64 = 0.45;
const CUT_ENDS: f64 = 0.51;
const MOVE_ENDS: f64 = 0.59;
const ROUNDS_END: [f64; 4] = [0.65, 0.85, 0.91, 0.93];
/// About how many passes a step between these makes.
const MIDWAY_PASSES: usize = 40;

/// The pieces of the own tiles, and of each the points that other tiles have, too.
type Made = (Vec<Piece>, Vec<Vec<Point>>);

/// The own tiles of the surface of a component. Edges are `edge_length` world units long, 0:
/// the default. `None` where the tiles of all processes do not make up a surface.
pub(crate) fn tiled_surface(
    parts: &[Part],
    grid: &Grid,
    (edge_length, side): (f64, usize),
    team: &mut Team,
    execution: &mut Execution,
) -> Result<Option<TileMesh>> {
    let mut component = Component::new(parts, grid, (edge_length, side), team, execution)?;
    // With edges that long a tile would be finished with a margin wider than several tiles.
    if FINISH_REACH * component.stages.wanted > 2.0 * side as f64 {
        return Ok(None);
    }
    let Some(contours) = component.contours(team, execution)? else {
        return Ok(None);
    };
    let cut = component.step(
        contours,
        (CUT_REACH, [CONTOUR_ENDS, CUT_ENDS]),
        Stages::cut,
        team,
        execution,
    )?;
    let Some((pieces, shared)) = cut else {
        return Ok(None);
    };
    let pieces = component.moved(pieces, &shared, team, execution)?;
    let share = [MOVE_ENDS, ROUNDS_END[0]];
    let led_on = component.step(pieces, (LEAD_REACH, share), Stages::led_on, team, execution)?;
    let Some((mut pieces, _)) = led_on else {
        return Ok(None);
    };
    component.stages.sums = Vec::new();
    for round in 0..SHIFTS.len() {
        pieces = component.remeshed(pieces, round, team, execution)?;
    }
    component.finished(pieces, team, execution)
}

/// A component that is worked on in tiles.
struct Component<'a> {
    stages: Stages<'a>,
    side: usize,
    /// What encloses the component.
    bounds: VoxelBox,
    tiles: Vec<Tile>,
    /// Whose each tile is, and the numbers of the own ones.
    workers: Vec<usize>,
    own: Vec<usize>,
    /// The component's span of the run's progress.
    span: [f64; 2],
}

impl<'a> Component<'a> {
    fn new(
        parts: &'a [Part],
        grid: &'a Grid,
        (edge_length, side): (f64, usize),
        team: &Team,
        execution: &Execution,
    ) -> Result<Self> {
        let stages = Stages::new(parts, grid, edge_length);
        let bounds = VoxelBox::around(parts);
        let tiling = Tiling::new(side, 0.0, &bounds, stages.h);
        let tiles = tiles(parts, &tiling)?;
        let workers = dealt(&tiles, team.processes())?;
        let all = 0..tiles.len();
        Ok(Self {
            own: collected(all.filter(|&t| workers[t] == team.process()))?,
            stages,
            side,
            bounds,
            tiles,
            workers,
            span: execution.span(),
        })
    }

    fn tiling(&self, shift: f64) -> Tiling {
        Tiling::new(self.side, shift, &self.bounds, self.stages.h)
    }

    /// Whether a point is in a tile.
    fn is_in<'b>(&self, tile: &'b Tile) -> impl Fn(Vec3) -> bool + Sync + 'b {
        let tiling = self.tiling(0.0);
        move |p| tiling.place(p) == tile.place
    }

    /// The boxes of the tiles and so much around them, work units.
    fn boxes(&self, reach: f64) -> Result<Vec<Corners>> {
        let boxes = self
            .tiles
            .iter()
            .map(|tile| tile.near.reaching(reach, self.stages.h));
        collected(boxes)
    }

    /// What a tile keeps of the surface that it made, as a piece, and its patches.
    fn piece(
        &self,
        tile: &Tile,
        surface: &Surface,
        execution: &mut Execution,
    ) -> Result<(Piece, Patches)> {
        let own = wanted(surface, self.is_in(tile), execution)?;
        let piece = Piece {
            made_in: (0, tile.place),
            surface: kept(surface, &own)?,
        };
        Ok((piece, Patches::new(surface, &own, execution)?))
    }

    /// The contours of the own tiles, wound. All processes learn the sums of all bricks.
    fn contours(
        &mut self,
        team: &mut Team,
        execution: &mut Execution,
    ) -> Result<Option<Vec<Piece>>> {
        let (mut pieces, mut patches, mut sums) = (Vec::new(), Vec::new(), Vec::new());
        for (i, &own) in self.own.iter().enumerate() {
            let tile = &self.tiles[own];
            let step = [0.0, CONTOUR_ENDS];
            self.take_progress(i, step, step, execution);
            let (surface, of_bricks) = self.stages.contour(&tile.near, CONTOUR_ENDS, execution)?;
            let tiling = self.tiling(0.0);
            let own = of_bricks
                .into_iter()
                .filter(|(_, brick, _)| tiling.place_of_brick(*brick) == tile.place);
            extend(&mut sums, collected(own)?)?;
            let (piece, of_tile) = self.piece(tile, &surface, execution)?;
            push(&mut pieces, piece)?;
            push(&mut patches, of_tile)?;
        }
        self.stages.sums = shared_sums(&sums, team)?;
        let Some(agreed) = agree(&self.own, &patches, team)? else {
            return Ok(None);
        };
        for ((piece, patches), turns) in pieces.iter_mut().zip(patches).zip(agreed.turns) {
            let triangles = piece.surface.triangles.iter_mut();
            for (triangle, (patch, turned)) in triangles.zip(patches.of_triangle) {
                if turned ^ turns[patch as usize] {
                    triangle.swap(1, 2);
                }
            }
        }
        Ok(Some(pieces))
    }

    /// What `work` makes of the surface around each own tile, as far as this reaches, given the pieces of
    /// these; `None` where the tiles of all do not make up a surface.
    fn step(
        &self,
        mut pieces: Vec<Piece>,
        (reach, share): (usize, [f64; 2]),
        work: impl Fn(&Stages<'a>, Surface, &VoxelBox, &mut Execution) -> Result<Surface>,
        team: &mut Team,
        execution: &mut Execution,
    ) -> Result<Option<Made>> {
        let boxes = self.boxes(reach as f64)?;
        let others = self.received(&pieces, &boxes, team, execution)?;
        extend(&mut pieces, others)?;
        let (mut made, mut patches) = (Vec::new(), Vec::new());
        for (i, &own) in self.own.iter().enumerate() {
            let tile = &self.tiles[own];
            self.take_progress(i, share, share, execution);
            execution.stage("Moving midway", share[0], share[1], MIDWAY_PASSES)?;
            let around = gathered(&pieces, boxes[own], execution)?;
            // From now on the tile's piece is wanted around later ones only.
            let later = &self.own[i + 1..];
            let is_wanted = |p: Vec3| later.iter().any(|&tile| is_within(boxes[tile], p));
            pieces[i].surface = chosen(&pieces[i].surface, is_wanted, execution)?;
            let surface = work(&self.stages, around, &tile.near.grown(reach), execution)?;
            let (piece, of_tile) = self.piece(tile, &surface, execution)?;
            push(&mut made, piece)?;
            push(&mut patches, of_tile)?;
        }
        let agreed = agree(&self.own, &patches, team)?.filter(|agreed| agreed.is_wound);
        let shared = collected(patches.into_iter().map(|patches| patches.shared))?;
        Ok(agreed.map(|_| (made, shared)))
    }

    /// What other processes have in the boxes of the own tiles.
    fn received(
        &self,
        pieces: &[Piece],
        boxes: &[Corners],
        team: &mut Team,
        execution: &Execution,
    ) -> Result<Vec<Piece>> {
        let mut of_process = vec![Vec::new(); team.processes()];
        for (&worker, corners) in self.workers.iter().zip(boxes) {
            push(&mut of_process[worker], *corners)?;
        }
        received(pieces, &of_process, team, execution)
    }

    /// Moves the points of all pieces midway. What moves a point far off may have a part in where it goes,
    /// so that two tiles do not see all of that: there the first one decides.
    fn moved(
        &self,
        mut pieces: Vec<Piece>,
        points: &[Vec<Point>],
        team: &mut Team,
        execution: &mut Execution,
    ) -> Result<Vec<Piece>> {
        let boxes = self.boxes(MOVE_REACH as f64)?;
        let others = self.received(&pieces, &boxes, team, execution)?;
        let (mut places, mut shared) = (Vec::new(), Vec::new());
        for (i, &own) in self.own.iter().enumerate() {
            let share = [CUT_ENDS, MOVE_ENDS];
            self.take_progress(i, share, share, execution);
            execution.stage("Moving midway", share[0], share[1], MIDWAY_PASSES)?;
            let around = gathered(pieces.iter().chain(&others), boxes[own], execution)?;
            let near = self.tiles[own].near.grown(MOVE_REACH);
            let moved = self.stages.moved(&around, &near, execution)?;
            let to = |point: Point| number(&around, point).map_or(point.place, |p| moved[p]);
            let surface = &pieces[i].surface;
            let mut of_piece: Vec<Vec3> = zeros(surface.points.len())?;
            execution.in_pool(|| {
                let all = of_piece.par_iter_mut().enumerate();
                all.for_each(|(p, place)| *place = to(Point::of(surface, p)));
            });
            push(&mut places, of_piece)?;
            let of_shared = points[i].iter().map(|&point| (point, to(point)));
            push(&mut shared, (own, collected(of_shared)?))?;
        }
        let moves = moved_alike(&shared, team)?;
        for (Piece { surface, .. }, mut places) in pieces.iter_mut().zip(places) {
            execution.in_pool(|| {
                let all = places.par_iter_mut().enumerate();
                all.for_each(|(p, place)| {
                    *place = moves.of(Point::of(surface, p)).unwrap_or(*place);
                });
            });
            surface.points = places;
        }
        Ok(pieces)
    }

    /// The surface in new triangles: in the first round within the tiles, then across the seams of the
    /// rounds before, again in tiles.
    fn remeshed(
        &self,
        mut pieces: Vec<Piece>,
        round: usize,
        team: &mut Team,
        execution: &mut Execution,
    ) -> Result<Vec<Piece>> {
        execution.within(self.span[0], self.span[1]);
        let far = ACROSS * self.stages.wanted;
        let earlier = SHIFTS.map(|shift| self.tiling(shift));
        let (earlier, tiling) = (&earlier[..round], earlier[round]);
        let is_wanted = |p: Vec3| earlier.iter().all(|t| t.is_near_border(p, far));
        let mut are_wanted = Vec::new();
        for Piece { surface, .. } in &pieces {
            push(&mut are_wanted, wanted(surface, is_wanted, execution)?)?;
        }
        let places = places(&pieces, &tiling, &are_wanted, team, execution)?;
        let boxes = places.iter().map(|place| {
            let [low, high] = tiling.corners(*place);
            [low.map(|v| v - far), high.map(|v| v + far)]
        });
        let boxes: Vec<Corners> = collected(boxes)?;
        let mut of_process = vec![Vec::new(); team.processes()];
        for (i, corners) in boxes.iter().enumerate() {
            push(&mut of_process[i % team.processes()], *corners)?;
        }
        let others = received(&pieces, &of_process, team, execution)?;
        let mut made = Vec::new();
        let before = if round == 0 {
            Before::Any
        } else {
            Before::Remeshed
        };
        for i in (team.process()..places.len()).step_by(team.processes()) {
            let [from, to] = [ROUNDS_END[round], ROUNDS_END[round + 1]];
            let at =
                |tile: usize| from + (to - from) * (tile as f64 / places.len() as f64).min(1.0);
            execution.stage("Remeshing", at(i), at(i + team.processes()), 1)?;
            let around = gathered(pieces.iter().chain(&others), boxes[i], execution)?;
            let is_own = |p: Vec3| tiling.place(p) == places[i] && is_wanted(p);
            let surface = self.stages.remeshed(&around, is_own, before, execution)?;
            let made_in = (round, places[i]);
            push(&mut made, Piece { made_in, surface })?;
        }
        for (Piece { surface, .. }, mut stays) in pieces.iter_mut().zip(are_wanted) {
            stays.iter_mut().for_each(|stays| *stays = !*stays);
            *surface = kept(surface, &stays)?;
        }
        pieces.retain(|piece| !piece.surface.triangles.is_empty());
        extend(&mut pieces, made)?;
        Ok(pieces)
    }

    /// The finished mesh of the own tiles; `None` where the pieces of all do not fit together.
    fn finished(
        &self,
        mut pieces: Vec<Piece>,
        team: &mut Team,
        execution: &mut Execution,
    ) -> Result<Option<TileMesh>> {
        let reach = FINISH_REACH * self.stages.wanted;
        let boxes = self.boxes(reach)?;
        let others = self.received(&pieces, &boxes, team, execution)?;
        extend(&mut pieces, others)?;
        let (mut meshes, mut patches) = (Vec::new(), Vec::new());
        for (i, &own) in self.own.iter().enumerate() {
            let step = [ROUNDS_END[SHIFTS.len()], 1.0];
            self.take_progress(i, step, [FINISH_BEGINS, 1.0], execution);
            let tile = &self.tiles[own];
            let around = gathered(&pieces, boxes[own], execution)?;
            let near = tile.near.grown(reach.ceil() as usize);
            let is_own = self.is_in(tile);
            let (surface, mesh, own) = self.stages.finished(around, &near, is_own, execution)?;
            push(&mut meshes, TileMesh::new(&mesh, &surface, &own)?)?;
            push(&mut patches, Patches::new(&surface, &own, execution)?)?;
        }
        let Some(agreed) = agree(&self.own, &patches, team)?.filter(|agreed| agreed.is_wound)
        else {
            return Ok(None);
        };
        for ((mesh, patches), turns) in meshes.iter_mut().zip(&patches).zip(&agreed.turns) {
            mesh.turn(patches, turns)?;
        }
        assembled(meshes).map(Some)
    }

    /// Lets the `stages` of the own tile with this number take its share of the `step`, both as shares of
    /// the component's progress.
    fn take_progress(
        &self,
        tile: usize,
        step: [f64; 2],
        stages: [f64; 2],
        execution: &mut Execution,
    ) {
        let share = (step[1] - step[0]) / self.own.len() as f64;
        let width = share / (stages[1] - stages[0]);
        let from = step[0] + tile as f64 * share - stages[0] * width;
        let at = |done: f64| self.span[0] + done * (self.span[1] - self.span[0]);
        execution.within(at(from), at(from + width));
    }
}

/// Whose each tile is: the fullest first goes to the process that has least.
fn dealt(tiles: &[Tile], processes: usize) -> Result<Vec<usize>> {
    let mut order = collected(0..tiles.len())?;
    order.sort_unstable_by_key(|&t| (Reverse(tiles[t].voxels), t));
    let mut load = vec![0; processes];
    let mut workers = filled(0, tiles.len())?;
    for t in order {
        let worker = (0..processes).min_by_key(|&p| load[p]).unwrap_or(0);
        load[worker] += tiles[t].voxels;
        workers[t] = worker;
    }
    Ok(workers)
}

/// The sums of the bricks of all processes, ordered by part and place.
fn shared_sums(own: &[BrickSums], team: &mut Team) -> Result<Vec<BrickSums>> {
    let mut message = Vec::new();
    for (part, place, sums) in own {
        extend(&mut message, [i64::from(*part)])?;
        extend(&mut message, place.map(|v| v as i64))?;
        extend(&mut message, sums.map(|v| v.to_bits().into()))?;
    }
    let mut all = Vec::new();
    for message in team.share(&message)? {
        for numbers in message.chunks_exact(6) {
            let &[part, x, y, z, sum, count] = numbers else {
                return Err(Error::Pieces);
            };
            let place = [x, y, z].map(|v| v as usize);
            let sums = [sum, count].map(|v| f32::from_bits(v as u32));
            push(&mut all, (part as u32, place, sums))?;
        }
    }
    all.sort_unstable_by_key(|&(part, place, _)| (part, place));
    Ok(all)
}

/// The tiles in which there are triangles of any process that are wanted, in order.
fn places(
    pieces: &[Piece],
    tiling: &Tiling,
    are_wanted: &[Vec<bool>],
    team: &mut Team,
    execution: &Execution,
) -> Result<Vec<Place>> {
    let mut places = BTreeSet::new();
    for (Piece { surface, .. }, wanted) in pieces.iter().zip(are_wanted) {
        let place_of = |t: usize| tiling.place(centre(surface, t));
        let add = |mut places: BTreeSet<Place>, t: usize| {
            if wanted[t] {
                places.insert(place_of(t));
            }
            places
        };
        let of_piece = execution.in_pool(|| {
            let all = (0..wanted.len()).into_par_iter();
            all.fold(BTreeSet::new, add)
                .reduce(BTreeSet::new, |mut a, mut b| {
                    a.append(&mut b);
                    a
                })
        });
        places.extend(of_piece);
    }
    let message: Vec<i64> = places.iter().flatten().map(|&v| v.into()).collect();
    for message in team.share(&message)? {
        let of_process = message.chunks_exact(3);
        places.extend(of_process.map(|place| [0, 1, 2].map(|a| place[a] as i32)));
    }
    collected(places)
}

#[cfg(test)]
#[path = "tiled_surface_tests.rs"]
mod tests;
