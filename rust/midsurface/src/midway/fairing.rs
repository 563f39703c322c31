//! Surface → surface that is fair where no faces are seen.
//!
//! Where sheets meet a point sees at most one face of its own sheet: looking for the other it looks
//! into the sheet that joins. Neither the faces nor the profile tell where the sheet is; both pull
//! it towards the one that joins. But a membrane goes on as it comes: there the points are moved along
//! their normals to where the surface bends least, in least squares of its mean curvature (fairing,
//! as in Botsch and Kobbelt 2004, "An intuitive framework for real-time freeform modeling"), given
//! the points around that do see.
//!
//! Zones of such points are solved for one by one, by conjugate gradients in as many steps as it
//! takes for a wave across the widest junctions, and no more. Next to a rim of the surface nothing is
//! done: what is known on one side only says little about the other one.

use crate::buckets::Buckets;
use crate::error::{collected, extend, filled, push, zeros, Result};
use crate::execution::Execution;
use crate::grid::{dot, sub, Vec3};
use crate::reading::components::DisjointSets;
use crate::surface::halfedge::Fans;
use crate::surface::manifold::Surface;

/// Steps of conjugate gradients at most, and the share of the first residual that is enough.
const STEPS: usize = 200;
const ENOUGH: f64 = 1e-3;
/// A point moves no farther, work units.
const FARTHEST: f64 = 2.0;
/// No zone.
const NONE: u32 = u32::MAX;

/// Passes that [`fair`] makes, for its progress.
pub(crate) const PASSES: usize = 1;

/// The `blind` points of a surface, and how far each of them goes along its normal.
pub(crate) fn fair(
    surface: &Surface,
    normals: &[Vec3],
    blind: &[bool],
    (fans, neighbours): (&Fans, &Buckets<u32>),
    execution: &mut Execution,
) -> Result<Vec<(u32, f64)>> {
    let mut off = Vec::new();
    let (zones, number) = zones(blind, neighbours)?;
    let solved = execution.collect(zones.len(), |zone| {
        let own = &zones[zone];
        let system = System::new(surface, normals, own, (&number, blind), (fans, neighbours))?;
        system.solve()
    })?;
    for (zone, solved) in zones.iter().zip(solved) {
        let far = solved?
            .into_iter()
            .map(|far| far.clamp(-FARTHEST, FARTHEST));
        extend(&mut off, zone.iter().copied().zip(far))?;
    }
    Ok(off)
}

/// The blind points by connected zones, and each one's number in its own.
fn zones(blind: &[bool], neighbours: &Buckets<u32>) -> Result<(Vec<Vec<u32>>, Vec<u32>)> {
    let mut sets = DisjointSets::new(blind.len())?;
    let is_blind = |p: &usize| blind[*p];
    // Those around a point share its equation.
    let around = |p: usize| neighbours.of(p).iter().map(|&q| q as usize);
    for p in (0..blind.len()).filter(is_blind) {
        for q in around(p).flat_map(around).filter(is_blind) {
            sets.join(p, q);
        }
    }
    let mut zone_of = filled(NONE, blind.len())?;
    let mut number = zeros(blind.len())?;
    let mut zones: Vec<Vec<u32>> = Vec::new();
    for p in (0..blind.len()).filter(is_blind) {
        let root = sets.find(p);
        if zone_of[root] == NONE {
            zone_of[root] = zones.len() as u32;
            push(&mut zones, Vec::new())?;
        }
        let zone = &mut zones[zone_of[root] as usize];
        number[p] = zone.len() as u32;
        push(zone, p as u32)?;
    }
    Ok((zones, number))
}

/// One equation for the curvature at each inner point of a zone or next to it: coefficients by
/// unknowns, and what they are to add up to.
struct System {
    unknowns: usize,
    start: Vec<u32>,
    entries: Vec<(u32, f64)>,
    wanted: Vec<f64>,
}

impl System {
    fn new(
        surface: &Surface,
        normals: &[Vec3],
        zone: &[u32],
        (number, blind): (&[u32], &[bool]),
        (fans, neighbours): (&Fans, &Buckets<u32>),
    ) -> Result<Self> {
        let around = |&p: &u32| neighbours.of(p as usize).iter().copied();
        let mut rows = collected(zone.iter().flat_map(|p| around(p).chain([*p])))?;
        rows.sort_unstable();
        rows.dedup();
        rows.retain(|&p| !fans.is_boundary(&surface.triangles, p));
        let mut system = Self {
            unknowns: zone.len(),
            start: collected([0])?,
            entries: Vec::new(),
            wanted: zeros(rows.len())?,
        };
        for (&p, wanted) in rows.iter().zip(&mut system.wanted) {
            let n = normals[p as usize];
            let around = neighbours.of(p as usize);
            let share = 1.0 / around.len() as f64;
            for &q in around {
                let way = sub(surface.points[q as usize], surface.points[p as usize]);
                *wanted -= share * dot(n, way);
                if blind[q as usize] {
                    let entry = share * dot(n, normals[q as usize]);
                    push(&mut system.entries, (number[q as usize], entry))?;
                }
            }
            if blind[p as usize] {
                push(&mut system.entries, (number[p as usize], -1.0))?;
            }
            push(&mut system.start, system.entries.len() as u32)?;
        }
        Ok(system)
    }

    /// The residuals' change for a change of the unknowns.
    fn times(&self, x: &[f64], out: &mut [f64]) {
        for (out, ends) in out.iter_mut().zip(self.start.windows(2)) {
            let own = &self.entries[ends[0] as usize..ends[1] as usize];
            *out = own.iter().map(|&(k, v)| v * x[k as usize]).sum();
        }
    }

    fn times_transposed(&self, y: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        for (y, ends) in y.iter().zip(self.start.windows(2)) {
            for &(k, v) in &self.entries[ends[0] as usize..ends[1] as usize] {
                out[k as usize] += v * y;
            }
        }
    }

    /// Least squares by conjugate gradients (CGLS, Hestenes and Stiefel 1952).
    fn solve(&self) -> Result<Vec<f64>> {
        let squares = |v: &[f64]| v.iter().map(|v| v * v).sum::<f64>();
        let mut x: Vec<f64> = zeros(self.unknowns)?;
        let mut left = collected(self.wanted.iter().copied())?;
        let mut gradient: Vec<f64> = zeros(self.unknowns)?;
        self.times_transposed(&left, &mut gradient);
        let mut way = collected(gradient.iter().copied())?;
        let mut change: Vec<f64> = zeros(left.len())?;
        let mut size = squares(&gradient);
        let enough = ENOUGH * ENOUGH * size;
        for _ in 0..STEPS {
            self.times(&way, &mut change);
            let curvature = squares(&change);
            if size <= enough || curvature == 0.0 {
                break;
            }
            let step = size / curvature;
            x.iter_mut().zip(&way).for_each(|(x, way)| *x += step * way);
            left.iter_mut()
                .zip(&change)
                .for_each(|(left, c)| *left -= step * c);
            self.times_transposed(&left, &mut gradient);
            let before = std::mem::replace(&mut size, squares(&gradient));
            let turn = size / before;
            way.iter_mut()
                .zip(&gradient)
                .for_each(|(way, g)| *way = g + turn * *way);
        }
        Ok(x)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::execution::Quiet;
    use crate::grid::along;
    use crate::surface::normals::normals;

    const SIDE: u32 = 24;
    const RADIUS: f64 = 30.0;

    /// A quarter of a cylinder's side or so, with a bump in the middle that no point there sees.
    fn with_bump(height: f64) -> (Surface, Vec<bool>) {
        let mut surface = Surface::default();
        let (mut blind, middle) = (Vec::new(), 0.5 * f64::from(SIDE));
        for (j, i) in (0..=SIDE).flat_map(|j| (0..=SIDE).map(move |i| (j, i))) {
            let angle = (f64::from(i) - middle) / RADIUS;
            let from_middle = (f64::from(i) - middle)
                .abs()
                .max((f64::from(j) - middle).abs());
            let bump = height * (1.0 - from_middle / 4.0).max(0.0);
            let out = [angle.sin(), 0.0, angle.cos()];
            surface
                .points
                .push(along([0.0, f64::from(j), 0.0], RADIUS + bump, out));
            surface.source.push(0);
            blind.push(from_middle < 4.5);
        }
        for (j, i) in (0..SIDE).flat_map(|j| (0..SIDE).map(move |i| (j, i))) {
            let a = j * (SIDE + 1) + i;
            let [b, c, d] = [a + 1, a + SIDE + 2, a + SIDE + 1];
            surface.triangles.extend([[a, b, c], [a, c, d]]);
        }
        (surface, blind)
    }

    #[test]
    fn a_bump_that_nobody_sees_goes_and_the_bend_stays() {
        let (mut surface, blind) = with_bump(0.8);
        let mut quiet = Quiet::default();
        let execution = &mut Execution::new(2, &mut quiet).unwrap();
        let fans = Fans::new(&surface.triangles, surface.points.len()).unwrap();
        let around = fans.neighbours(&surface.triangles, execution).unwrap();
        for _ in 0..2 {
            let normals = normals(&surface.points, &surface.triangles, &fans, execution).unwrap();
            let off = fair(&surface, &normals, &blind, (&fans, &around), execution).unwrap();
            assert_eq!(off.len(), 81);
            for (p, off) in off {
                let p = p as usize;
                surface.points[p] = along(surface.points[p], off, normals[p]);
            }
        }
        for [x, _, z] in surface.points {
            assert!((x.hypot(z) - RADIUS).abs() < 0.06, "{}", x.hypot(z));
        }
    }

    #[test]
    fn where_all_see_nothing_moves() {
        let (surface, blind) = with_bump(0.8);
        let mut quiet = Quiet::default();
        let execution = &mut Execution::new(2, &mut quiet).unwrap();
        let fans = Fans::new(&surface.triangles, surface.points.len()).unwrap();
        let around = fans.neighbours(&surface.triangles, execution).unwrap();
        let normals = normals(&surface.points, &surface.triangles, &fans, execution).unwrap();
        let all_see = vec![false; blind.len()];
        let off = fair(&surface, &normals, &all_see, (&fans, &around), execution).unwrap();
        assert!(off.is_empty());
    }
}
