//! Stage 9, flattening terraces: a low-pass over the mesh.
//!
//! The faces of a label are known to a voxel, so that a sheet nearly parallel to a lattice plane
//! comes as terraces, longer than any Gaussian of the sheet's own scale. A windowed-sinc filter
//! (Taubin, Zhang and Golub 1996) removes them without shrinking what is curved: it is a polynomial
//! of the mesh's Laplacian K, close to 1 below the passband and to 0 above. The field it works on
//! is a move of each point along its normal, so that nothing slides within the surface. K weighs
//! neighbours by the inverse square of their distance, since where a sheet leans the slices' lines
//! lie far apart; on a boundary it follows the boundary. A lower passband would remove longer
//! terraces, too, but takes the bends of real membranes for such: what is nearly parallel to a
//! lattice plane, where terraces are long, may have a filter of its own, and so may rims, which are
//! rough: points on them have two neighbours in place of six, and see no faces of the label.

use crate::buckets::{self, Buckets};
use crate::error::{collected, zeros, Result};
use crate::execution::Execution;
use crate::finish::lattice::LatticePlane;
use crate::grid::{along, dot, length, sub, unit, Vec3};
use crate::surface::halfedge::{self, ends, previous, Fans, NONE};

/// A windowed-sinc filter.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LowPass {
    /// End of the passband among K's eigenvalues, 0 to 2.
    pub passband: f64,
    /// Degree of the polynomial: the higher, the steeper is the passband's end.
    pub degree: usize,
}

/// The filters for lines in slices. Near lattice planes waves are longer than elsewhere: of a tube along
/// z all slices have the same terraces.
pub(crate) const OF_LINES: Filters = Filters {
    usual: STRONG,
    stronger: Some(LowPass {
        passband: 0.0125,
        degree: 48,
    }),
    normal_rounds: 4,
};
/// A filter for long terraces: it takes waves of less than about fourteen edges.
pub(crate) const STRONG: LowPass = LowPass {
    passband: 0.05,
    degree: 24,
};

/// The filters of a mesh.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Filters {
    pub usual: LowPass,
    /// Where the sheet is nearly parallel to a lattice plane, and on boundaries where points move
    /// freely; `None`: the usual one.
    pub stronger: Option<LowPass>,
    /// Passes that smooth the normals along which heights are measured, and which tell how near to a
    /// lattice plane the sheet is: over few of them it seems to lean more where a terrace ends.
    pub normal_rounds: usize,
}

/// No point moves by more than this share of its line's edges: nearly half a voxel.
const MOST: f64 = 0.3;
/// Towards fixed points the bound on the moves shrinks to nothing over so many rings of points.
const RINGS: u8 = 6;
/// Points handed to a worker at a time.
const PIECE: usize = 1024;
/// Passes that finding the neighbours makes.
const PREPARING: usize = halfedge::TWIN_PASSES + buckets::PASSES;

impl Filters {
    /// Passes over the points that [`flatten_terraces`] makes, for its progress.
    pub const fn passes(&self) -> usize {
        let more = match self.stronger {
            Some(filter) => 2 * filter.degree,
            None => 0,
        };
        2 * self.usual.degree + more + self.normal_rounds + 2 + PREPARING
    }

    /// The same for slices that lie farther apart, whose terraces are longer: passbands are divided
    /// by the coarsest spacing.
    pub fn on_spacing(self, h: Vec3) -> Self {
        Self {
            usual: self.usual.on_spacing(h),
            stronger: self.stronger.map(|f| f.on_spacing(h)),
            ..self
        }
    }
}

impl LowPass {
    fn on_spacing(self, h: Vec3) -> Self {
        let coarsest = h.iter().copied().fold(1.0, f64::max);
        Self {
            passband: self.passband / coarsest,
            ..self
        }
    }

    /// Coefficients of the polynomial over Chebyshev's, under a Hamming window, summing to 1 so that
    /// flat stays flat.
    fn weights(&self) -> Vec<f64> {
        use std::f64::consts::PI;
        let theta = (1.0 - 0.5 * self.passband).acos();
        let mut weights: Vec<f64> = (0..=self.degree)
            .map(|n| {
                let window = 0.54 + 0.46 * (n as f64 * PI / (self.degree + 1) as f64).cos();
                let sinc = match n {
                    0 => theta / PI,
                    n => 2.0 * (n as f64 * theta).sin() / (n as f64 * PI),
                };
                window * sinc
            })
            .collect();
        let sum: f64 = weights.iter().sum();
        weights.iter_mut().for_each(|w| *w /= sum);
        weights
    }
}

/// How a point on a boundary moves.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) enum OnBoundary {
    #[default]
    Stays,
    /// Within the plane across this unit vector.
    Within(Vec3),
    /// Along this unit vector only.
    Along(Vec3),
    /// Along its normal, as all others do.
    Freely,
}

/// What the filter knows of a point and the line that it is on.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct LineOfPoint {
    /// Mean length of its edges.
    pub edge: f64,
    /// How it moves where it is on a boundary.
    pub on_boundary: OnBoundary,
    /// Farthest the point may move, so that it stays in the volume.
    pub room: f64,
    /// Whether it is in its component's first or last slice. Where the surface turns back there, so
    /// that the point is on no boundary, it stays: beyond there may be no volume.
    pub at_end: bool,
}

/// Neighbours of every point, with their weights in K. A point on a boundary has
/// neighbours along the boundary only.
struct Neighbours {
    list: Buckets<(u32, f32)>,
    boundary: Vec<bool>,
}

/// Smooths the points of a manifold, given by its triangles and their fans, along their `normals`.
/// `lines` tells of every point how it may move, `lattice` which
/// lattice planes count.
pub(crate) fn flatten_terraces(
    points: &mut [Vec3],
    (triangles, fans): (&[[u32; 3]], &Fans),
    normals: &[Vec3],
    lines: &[LineOfPoint],
    (filters, lattice): (Filters, &[LatticePlane]),
    execution: &mut Execution,
) -> Result<()> {
    if triangles.is_empty() {
        return Ok(());
    }
    let neighbours = Neighbours::new((triangles, fans), points, lines, execution)?;
    let rings = neighbours.rings(lines)?;
    let moves = moves(
        points,
        (normals, lines),
        (&neighbours, &rings),
        (filters, lattice),
        execution,
    )?;
    for (i, point) in points.iter_mut().enumerate() {
        let way = match lines[i].on_boundary {
            OnBoundary::Within(across) if neighbours.boundary[i] => within(normals[i], across),
            OnBoundary::Along(line) if neighbours.boundary[i] => along_line(normals[i], line),
            _ => normals[i],
        };
        if lines[i].at_end && !neighbours.boundary[i] {
            continue;
        }
        let most = MOST * lines[i].edge * f64::from(rings[i]) / f64::from(RINGS);
        let most = most.min(lines[i].room / length(way));
        *point = along(*point, moves[i].clamp(-most, most), way);
    }
    Ok(())
}

/// The vector within a plane that moves a surface by 1 along its normal, or less where the surface
/// lies flat in the plane.
fn within(normal: Vec3, across: Vec3) -> Vec3 {
    let within = along(normal, -dot(normal, across), across);
    within.map(|v| v / dot(within, within).max(0.25))
}

/// As [`within`], along a line.
fn along_line(normal: Vec3, line: Vec3) -> Vec3 {
    let share = dot(normal, line);
    line.map(|v| v * share / (share * share).max(0.25))
}

/// How far the filters would move each point along its normal.
fn moves(
    points: &[Vec3],
    (normals, lines): (&[Vec3], &[LineOfPoint]),
    (neighbours, rings): (&Neighbours, &[u8]),
    (filters, lattice): (Filters, &[LatticePlane]),
    execution: &mut Execution,
) -> Result<Vec<f64>> {
    let smoothed = neighbours.smooth_normals(normals, filters.normal_rounds, execution)?;
    let mut heights: Vec<f64> = zeros(points.len())?;
    execution.fill(&mut heights, PIECE, |piece, out| {
        for (i, out) in out.iter_mut().enumerate() {
            let p = piece * PIECE + i;
            let height = |q: usize| dot(sub(points[q], points[p]), smoothed[p]);
            *out = neighbours.of(p).map(|(q, w)| w * height(q)).sum();
        }
    })?;
    let mut moves = twiced(&heights, neighbours, filters.usual, execution)?;
    if let Some(filter) = filters.stronger {
        let others = twiced(&heights, neighbours, filter, execution)?;
        for (p, (own, other)) in moves.iter_mut().zip(others).enumerate() {
            if neighbours.is_rim(p, lines) {
                *own = other;
                continue;
            }
            let share = f64::from(rings[p]) / f64::from(RINGS);
            let near = lattice
                .iter()
                .map(|plane| (plane.nearness(smoothed[p]), plane.most_off));
            let nearest = |a: (f64, f64), b: (f64, f64)| if b.0 > a.0 { b } else { a };
            let (nearness, most_off) = near.fold((0.0, 0.0), nearest);
            *own += share * nearness * (other - *own).clamp(-most_off, most_off);
        }
    }
    Ok(moves)
}

/// How far a low-pass would move each point. A polynomial f alone would shrink what is curved by its
/// slope at 0. Tukey's twicing, which filters what f took away and gives it back, has the response
/// 2 f − f² and no slope there.
fn twiced(
    heights: &[f64],
    neighbours: &Neighbours,
    filter: LowPass,
    execution: &mut Execution,
) -> Result<Vec<f64>> {
    let weights = filter.weights();
    let start = zeros(heights.len())?;
    let mut moves = low_pass(start, Some(heights), neighbours, &weights, execution)?;
    let start = collected(moves.iter().copied())?;
    let given_back = low_pass(start, None, neighbours, &weights, execution)?;
    for (shift, back) in moves.iter_mut().zip(given_back) {
        *shift -= back;
    }
    Ok(moves)
}

/// The polynomial of the Laplacian, applied to a field by Chebyshev's recurrence: T₀ = x,
/// T₁ = (1 − K/2) x, Tₙ₊₁ = 2 (1 − K/2) Tₙ − Tₙ₋₁. The field is relative to a surface over whose
/// points their neighbours rise by `heights`; `weights` are the polynomial's.
fn low_pass(
    mut before: Vec<f64>,
    heights: Option<&[f64]>,
    neighbours: &Neighbours,
    weights: &[f64],
    execution: &mut Execution,
) -> Result<Vec<f64>> {
    let mut now: Vec<f64> = zeros(before.len())?;
    let step = |field: &[f64], p: usize| {
        let height = heights.map_or(0.0, |heights| heights[p]);
        field[p] + 0.5 * (neighbours.rise(field, p) + height)
    };
    execution.fill(&mut now, PIECE, |piece, out| {
        for (i, out) in out.iter_mut().enumerate() {
            *out = step(&before, piece * PIECE + i);
        }
    })?;
    let start = |(a, b): (&f64, &f64)| weights[0] * a + weights[1] * b;
    let mut sum = collected(before.iter().zip(&now).map(start))?;
    for &weight in &weights[2..] {
        execution.fill(&mut before, PIECE, |piece, out| {
            for (i, out) in out.iter_mut().enumerate() {
                *out = 2.0 * step(&now, piece * PIECE + i) - *out;
            }
        })?;
        std::mem::swap(&mut before, &mut now);
        for (sum, t) in sum.iter_mut().zip(&now) {
            *sum += weight * t;
        }
    }
    Ok(sum)
}

impl Neighbours {
    fn new(
        (triangles, fans): (&[[u32; 3]], &Fans),
        points: &[Vec3],
        lines: &[LineOfPoint],
        execution: &mut Execution,
    ) -> Result<Self> {
        let twins = halfedge::twins(triangles, points.len(), execution)?;
        let is_outer = |e: &u32| twins[*e as usize] == NONE;
        let mut boundary: Vec<bool> = zeros(points.len())?;
        execution.fill(&mut boundary, PIECE, |piece, out| {
            for (i, out) in out.iter_mut().enumerate() {
                let mut leaving = fans.of((piece * PIECE + i) as u32).iter();
                *out = leaving.any(|&e| is_outer(&e) || is_outer(&previous(e)));
            }
        })?;
        let weight = |share: f64, a: usize, b: u32| {
            let d = sub(points[b as usize], points[a]);
            (
                b,
                (share * (lines[a].edge.powi(2) / dot(d, d)).min(1.0)) as f32,
            )
        };
        let add = |p: usize, list: &mut Vec<(u32, f32)>| {
            if boundary[p] {
                // Along a line a bend shows twice as much as on average over all directions.
                let mut beside: Vec<(u32, u32)> = Vec::new();
                for &e in fans.of(p as u32) {
                    let ahead = (e, ends(triangles, e).1);
                    let back = (previous(e), ends(triangles, previous(e)).0);
                    beside.extend([ahead, back].into_iter().filter(|(e, _)| is_outer(e)));
                }
                beside.sort_unstable();
                let share = 0.5 / beside.len() as f64;
                list.extend(beside.iter().map(|&(_, q)| weight(share, p, q)));
            } else {
                let leaving = fans.of(p as u32);
                let share = 1.0 / leaving.len() as f64;
                list.extend(
                    leaving
                        .iter()
                        .map(|&e| weight(share, p, ends(triangles, e).1)),
                );
            }
        };
        let list = Buckets::fill(points.len(), 3 * triangles.len(), add, execution)?;
        Ok(Self { list, boundary })
    }

    /// The neighbours of point p with their weights.
    fn of(&self, p: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let list = self.list.of(p).iter();
        list.map(|&(q, w)| (q as usize, f64::from(w)))
    }

    /// Whether a point is on a boundary where it moves freely.
    fn is_rim(&self, p: usize, lines: &[LineOfPoint]) -> bool {
        self.boundary[p] && matches!(lines[p].on_boundary, OnBoundary::Freely)
    }

    /// How much higher than at a point a field is at its neighbours: −K of it.
    fn rise(&self, field: &[f64], p: usize) -> f64 {
        self.of(p).map(|(q, w)| w * (field[q] - field[p])).sum()
    }

    /// Normals averaged over some rings, in which terraces do not show.
    fn smooth_normals(
        &self,
        normals: &[Vec3],
        passes: usize,
        execution: &mut Execution,
    ) -> Result<Vec<Vec3>> {
        let mut smooth = collected(normals.iter().copied())?;
        let mut next: Vec<Vec3> = zeros(normals.len())?;
        for _ in 0..passes {
            execution.fill(&mut next, PIECE, |piece, out| {
                for (i, out) in out.iter_mut().enumerate() {
                    let p = piece * PIECE + i;
                    let sum = self
                        .of(p)
                        .fold(smooth[p], |n, (q, _)| along(n, 1.0, smooth[q]));
                    *out = unit(sum);
                }
            })?;
            std::mem::swap(&mut smooth, &mut next);
        }
        Ok(smooth)
    }

    /// Rings of points between each point and one that stays, at most [`RINGS`].
    fn rings(&self, lines: &[LineOfPoint]) -> Result<Vec<u8>> {
        let stays =
            |p: usize| self.boundary[p] && matches!(lines[p].on_boundary, OnBoundary::Stays);
        let mut rings = collected((0..lines.len()).map(|p| if stays(p) { 0 } else { RINGS }))?;
        for ring in 1..RINGS {
            for p in 0..rings.len() {
                if rings[p] > ring && self.of(p).any(|(q, _)| rings[q] == ring - 1) {
                    rings[p] = ring;
                }
            }
        }
        Ok(rings)
    }
}
