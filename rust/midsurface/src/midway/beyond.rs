//! Surface → surface that runs on beyond the border of the volume, and back.
//!
//! What lies beyond the border is unknown, not background. Were the points on it held there while
//! the surface moves, a leaning sheet would be bent at its end, or pulled back from it. So the
//! surface is first led on beyond the border, straight, moves as a whole, and is then cut where it
//! passes the border. What a strip cannot make up for is a contour that ends before the border.

use crate::contour::scraps::drop_pieces;
use crate::contour::trim::cut;
use crate::error::{check_count, collected, extend, filled, push, Result};
use crate::grid::{along, dot, length, unit, Vec3};
use crate::surface::halfedge::{ends, Fans, NONE};
use crate::surface::manifold::Surface;
use crate::surface::normals::normal_of_fan;
use crate::surface::region::Region;

/// A strip still reaches the border after so long a move along the normal, with as much more beyond
/// it; and is no longer than this, work units.
const MOVED: f64 = 2.0;
const MORE: f64 = 1.0;
const LONGEST: f64 = 8.0;
/// The least that a step along the sheet counts as going outward: a sheet along the border never
/// leaves the volume.
const LEANING: f64 = 0.01;
/// Times that the way out is mended, where it has to lead beyond several borders.
const ROUNDS: usize = 8;
/// Rounds of averaging normals.
const NORMAL_ROUNDS: usize = 8;
/// A point this near to the border was cut there, work units.
const ON_BORDER: f64 = 1e-6;
/// Smaller pieces are dropped where the border cut them, square work units.
const LEAST: f64 = 3.0;

/// Leads a consistently wound surface on beyond the border, from its edges that lie on that. The
/// points from which new ones were led on are returned, in the order of the new ones.
pub(crate) fn lead_beyond(surface: &mut Surface, fans: &Fans, last: Vec3) -> Result<Vec<u32>> {
    let edges = edges_on_border(surface, fans, last)?;
    let count = surface.points.len();
    let mut new = filled(NONE, count)?;
    let mut led_on = Vec::new();
    for &p in edges.as_flattened() {
        if new[p as usize] == NONE {
            new[p as usize] = (count + led_on.len()) as u32;
            push(&mut led_on, p)?;
        }
    }
    let places = places_beyond(surface, fans, &led_on, last)?;
    check_count("points", count + led_on.len(), 1)?;
    extend(&mut surface.points, places)?;
    let sources = collected(led_on.iter().map(|&p| surface.source[p as usize]))?;
    extend(&mut surface.source, sources)?;
    let most = surface.triangles.len() + 2 * edges.len();
    check_count("triangles", most, 3)?;
    let strips = edges.iter().flat_map(|&[u, v]| {
        let [far_u, far_v] = [u, v].map(|p| new[p as usize]);
        [[v, u, far_u], [v, far_u, far_v]]
    });
    extend(&mut surface.triangles, strips)?;
    Ok(led_on)
}

/// The boundary's edges on the border of the volume.
fn edges_on_border(surface: &Surface, fans: &Fans, last: Vec3) -> Result<Vec<[u32; 2]>> {
    let triangles = &surface.triangles;
    let at = |p: u32| outward(surface.points[p as usize], last);
    let mut edges = Vec::new();
    for e in 0..3 * triangles.len() as u32 {
        let (u, v) = ends(triangles, e);
        let (at_u, at_v) = (at(u), at(v));
        let on_border = (0..3).any(|a| at_u[a] != 0.0 && at_u[a] == at_v[a]);
        if on_border && fans.twin(triangles, e) == NONE {
            push(&mut edges, [u, v])?;
        }
    }
    Ok(edges)
}

/// Where the surface is led to from each of these points. Their normals are averaged: those of a few
/// triangles at the boundary say little, and strips of different directions would tangle.
fn places_beyond(surface: &Surface, fans: &Fans, points: &[u32], last: Vec3) -> Result<Vec<Vec3>> {
    let (of_surface, triangles) = (&surface.points, &surface.triangles);
    let seeds = collected(points.iter().copied())?;
    let region = Region::new(seeds, NORMAL_ROUNDS, of_surface.len(), (triangles, fans))?;
    let normal = |&p: &u32| normal_of_fan(of_surface, triangles, fans.of(p));
    let normals = collected(region.points.iter().map(normal))?;
    let normals = region.average(normals, NORMAL_ROUNDS)?;
    let places = points.iter().zip(normals).map(|(&p, normal)| {
        let p = of_surface[p as usize];
        along(p, 1.0, way_out(unit(normal), outward(p, last)))
    });
    collected(places)
}

/// For each axis, on which border of the volume a point lies: −1 for the low one, 1 for the high one,
/// 0 for none.
fn outward(p: Vec3, last: Vec3) -> Vec3 {
    std::array::from_fn(|a| f64::from(u8::from(p[a] >= last[a])) - f64::from(u8::from(p[a] <= 0.0)))
}

/// The way out of the volume within a sheet of this normal, beyond all borders that a point lies on.
fn way_out(normal: Vec3, outward: Vec3) -> Vec3 {
    let mut way = [0.0; 3];
    for _ in 0..ROUNDS {
        for a in (0..3).filter(|&a| outward[a] != 0.0) {
            let out: Vec3 = std::array::from_fn(|k| if k == a { outward[a] } else { 0.0 });
            let within = along(out, -dot(out, normal), normal);
            let missing = MORE + MOVED * normal[a].abs() - dot(way, out);
            if missing > 0.0 {
                way = along(way, missing / dot(within, within).max(LEANING), within);
            }
        }
    }
    let share = LONGEST / length(way).max(LONGEST);
    way.map(|v| share * v)
}

/// Cuts off what lies beyond the border, and drops the pieces that are hardly more than a triangle
/// then.
pub(crate) fn cut_at_border(surface: &mut Surface, last: Vec3) -> Result<()> {
    for (a, last) in last.into_iter().enumerate() {
        for (border, inward) in [(0.0, 1.0), (last, -1.0)] {
            let depth = |p: &Vec3| inward * (p[a] - border);
            if surface.points.iter().all(|p| depth(p) >= 0.0) {
                continue;
            }
            let depths = collected(surface.points.iter().map(depth))?;
            let inside = collected(depths.iter().map(|&depth| depth >= 0.0))?;
            cut(surface, &depths, 0.0, &inside)?;
            for p in surface.points.iter_mut().filter(|p| depth(p) < ON_BORDER) {
                p[a] = border;
            }
        }
    }
    drop_pieces(surface, LEAST)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_way_out_lies_in_the_sheet_and_leads_beyond_all_borders() {
        let s = 0.5f64.sqrt();
        for (normal, outward) in [
            ([1.0, 0.0, 0.0], [0.0, 0.0, 1.0]),
            ([s, 0.0, s], [0.0, 0.0, -1.0]),
            ([0.6, 0.0, 0.8], [0.0, 1.0, -1.0]),
            ([s, s, 0.0], [1.0, -1.0, 0.0]),
        ] {
            let way = way_out(normal, outward);
            assert!(dot(way, normal).abs() < 1e-9, "{normal:?}: {way:?}");
            for a in (0..3).filter(|&a| outward[a] != 0.0) {
                let beyond = way[a] * outward[a];
                assert!(
                    beyond > 0.99 * (1.0 + 2.0 * normal[a].abs()),
                    "{normal:?}: {way:?}"
                );
            }
        }
    }

    #[test]
    fn a_surface_that_is_led_on_and_cut_is_the_surface_again() {
        // A plane that leans, in triangles, between the borders x = 0 and x = 4.
        let points = (0..15).map(|i| [f64::from(i % 5), f64::from(i / 5) + 1.0, 2.0]);
        let points: Vec<Vec3> = points.map(|[x, y, z]| [x, y, z + 0.3 * x]).collect();
        let quads = (0..8).map(|i| i % 4 + 5 * (i / 4));
        let triangles = quads.flat_map(|a| [[a, a + 1, a + 6], [a, a + 6, a + 5]]);
        let mut surface = Surface {
            source: vec![0; points.len()],
            triangles: triangles.collect(),
            points,
        };
        let area = |surface: &Surface| -> f64 {
            let corner = |p: u32| surface.points[p as usize];
            let of = |&[a, b, c]: &[u32; 3]| {
                let [u, v] = [b, c].map(|p| crate::grid::sub(corner(p), corner(a)));
                0.5 * length(crate::grid::cross(u, v))
            };
            surface.triangles.iter().map(of).sum()
        };
        let before = area(&surface);
        let last = [4.0, 9.0, 9.0];
        let fans = Fans::new(&surface.triangles, surface.points.len()).unwrap();
        let led_on = lead_beyond(&mut surface, &fans, last).unwrap();
        assert_eq!(led_on.len(), 6);
        assert_eq!(surface.points.len(), 21);
        assert!(area(&surface) > before + 4.0);
        cut_at_border(&mut surface, last).unwrap();
        let after = area(&surface);
        assert!((after - before).abs() < 1e-5, "{after} not {before}");
        let within = |t: &[u32; 3]| {
            t.iter()
                .all(|&p| (0.0..=4.0).contains(&surface.points[p as usize][0]))
        };
        assert!(surface.triangles.iter().all(within));
    }
}
