//! Stage 9, flattening terraces: a low-pass over the mesh.
//!
//! The faces of a label are known to a voxel, so that a sheet nearly parallel to a grid plane comes
//! as terraces, longer than any Gaussian of the sheet's own scale. A windowed-sinc filter (Taubin,
//! Zhang and Golub 1996) removes them without shrinking what is curved: it is a polynomial of the
//! mesh's Laplacian K, close to 1 below the passband and to 0 above. Points move along their normals
//! only and by a bounded length; boundaries stay.

use crate::error::{zeros, Result};
use crate::execution::Execution;
use crate::grid::{along, dot, length, sub, Vec3};
use crate::halfedge::{ends, Edges, NONE};

/// End of the passband among K's eigenvalues, 0 to 2: waves of about a dozen edges.
const PASSBAND: f64 = 0.12;
/// Degree of the polynomial.
pub(crate) const DEGREE: usize = 16;
/// No point moves by more than this share of its longest edge: half a voxel at the usual step.
const MOST: f64 = 0.3;
/// Next to a boundary, which is fixed, the filter knows too little: over so many rings of points
/// its bound grows from nothing.
const RINGS: u8 = 6;
/// Points handed to a worker at a time.
const PIECE: usize = 1024;

/// Neighbours of every point: those of point p are `list[start[p] .. start[p + 1]]`; points on a
/// boundary have none, which fixes them.
struct Neighbours {
    start: Vec<u32>,
    list: Vec<u32>,
}

/// Smooths the points of a manifold along their `normals`.
pub(crate) fn flatten_terraces(
    points: &mut [Vec3],
    triangles: &[[u32; 3]],
    normals: &[Vec3],
    execution: &mut Execution,
) -> Result<()> {
    if triangles.is_empty() {
        return Ok(());
    }
    let neighbours = Neighbours::new(triangles, points.len());
    // A polynomial f alone would shrink what is curved by its slope at 0. Tukey's twicing, which
    // filters what f took away and gives it back, has the response 2 f − f² and no slope there.
    let smooth = low_pass(points, &neighbours, execution)?;
    let taken: Vec<Vec3> = points
        .iter()
        .zip(&smooth)
        .map(|(p, s)| sub(*p, *s))
        .collect();
    let given_back = low_pass(&taken, &neighbours, execution)?;
    let rings = neighbours.rings();
    let shift = |i: usize| {
        let most = MOST * neighbours.reach(points, i) * f64::from(rings[i]) / f64::from(RINGS);
        dot(sub(given_back[i], taken[i]), normals[i]).clamp(-most, most)
    };
    let shifts: Vec<f64> = (0..points.len()).map(shift).collect();
    for (i, point) in points.iter_mut().enumerate() {
        *point = along(*point, shifts[i], normals[i]);
    }
    Ok(())
}

/// The polynomial of the Laplacian, applied to a field by Chebyshev's recurrence: T₀ = x,
/// T₁ = (1 − K/2) x, Tₙ₊₁ = 2 (1 − K/2) Tₙ − Tₙ₋₁.
fn low_pass(
    field: &[Vec3],
    neighbours: &Neighbours,
    execution: &mut Execution,
) -> Result<Vec<Vec3>> {
    let weights = sinc_weights();
    let mut before: Vec<Vec3> = field.to_vec();
    let mut now: Vec<Vec3> = zeros(field.len())?;
    let step =
        |field: &[Vec3], p: usize| along(field[p], 0.5, sub(neighbours.mean(field, p), field[p]));
    execution.fill(&mut now, PIECE, |piece, out| {
        for (i, out) in out.iter_mut().enumerate() {
            *out = step(&before, piece * PIECE + i);
        }
    })?;
    let start =
        |(a, b): (&Vec3, &Vec3)| std::array::from_fn(|k| weights[0] * a[k] + weights[1] * b[k]);
    let mut sum: Vec<Vec3> = before.iter().zip(&now).map(start).collect();
    for &weight in &weights[2..] {
        execution.fill(&mut before, PIECE, |piece, out| {
            for (i, out) in out.iter_mut().enumerate() {
                let twice = step(&now, piece * PIECE + i);
                *out = std::array::from_fn(|k| 2.0 * twice[k] - out[k]);
            }
        })?;
        std::mem::swap(&mut before, &mut now);
        for (sum, t) in sum.iter_mut().zip(&now) {
            *sum = along(*sum, weight, *t);
        }
    }
    Ok(sum)
}

/// Coefficients of the polynomial over Chebyshev's, under a Hamming window, summing to 1 so that
/// flat stays flat.
fn sinc_weights() -> Vec<f64> {
    use std::f64::consts::PI;
    let theta = (1.0 - 0.5 * PASSBAND).acos();
    let mut weights: Vec<f64> = (0..=DEGREE)
        .map(|n| {
            let window = 0.54 + 0.46 * (n as f64 * PI / (DEGREE + 1) as f64).cos();
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

impl Neighbours {
    fn new(triangles: &[[u32; 3]], points: usize) -> Self {
        let twins = Edges::new(triangles, points).twins();
        let half_edges = || (0..twins.len() as u32).map(|e| (e, ends(triangles, e)));
        let mut fixed = vec![false; points];
        for (e, (a, b)) in half_edges() {
            if twins[e as usize] == NONE {
                fixed[a as usize] = true;
                fixed[b as usize] = true;
            }
        }
        let mut start = vec![0u32; points + 1];
        for (_, (a, _)) in half_edges() {
            start[a as usize + 1] += u32::from(!fixed[a as usize]);
        }
        for p in 0..points {
            start[p + 1] += start[p];
        }
        let mut at = start.clone();
        let mut list = vec![0; start[points] as usize];
        for (_, (a, b)) in half_edges() {
            if !fixed[a as usize] {
                list[at[a as usize] as usize] = b;
                at[a as usize] += 1;
            }
        }
        Self { start, list }
    }

    /// Rings of points between each point and a boundary, at most [`RINGS`].
    fn rings(&self) -> Vec<u8> {
        let count = self.start.len() - 1;
        let own = |p: usize| &self.list[self.start[p] as usize..self.start[p + 1] as usize];
        let mut rings: Vec<u8> = (0..count)
            .map(|p| if own(p).is_empty() { 0 } else { RINGS })
            .collect();
        for ring in 1..RINGS {
            for p in 0..count {
                if rings[p] > ring && own(p).iter().any(|&q| rings[q as usize] == ring - 1) {
                    rings[p] = ring;
                }
            }
        }
        rings
    }

    /// Length of a point's longest edge.
    fn reach(&self, points: &[Vec3], p: usize) -> f64 {
        let own = &self.list[self.start[p] as usize..self.start[p + 1] as usize];
        let edges = own
            .iter()
            .map(|&q| length(sub(points[q as usize], points[p])));
        edges.fold(0.0, f64::max)
    }

    /// Mean of a field over a point's neighbours; the point's own value where it is fixed.
    fn mean(&self, field: &[Vec3], p: usize) -> Vec3 {
        let own = &self.list[self.start[p] as usize..self.start[p + 1] as usize];
        if own.is_empty() {
            return field[p];
        }
        let sum = own
            .iter()
            .fold([0.0; 3], |sum, &q| along(sum, 1.0, field[q as usize]));
        sum.map(|v| v / own.len() as f64)
    }
}
