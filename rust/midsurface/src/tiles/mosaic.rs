//! A surface in pieces, each of which is held by the process that made it.
//!
//! The pieces have no point numbers in common: where two of them meet both have the same points, exact to
//! the bit. To work on a place is to gather the triangles in a box around it from all pieces into one
//! surface, in an order that does not depend on how much is gathered, to change it, and to keep those
//! triangles whose centres are in the place. So two places that see the same of each other agree on what is
//! at the border between them. What a process lacks for its boxes the others send it.

use rayon::prelude::*;

use crate::error::{collected, extend, filled, push, reserved, zeros, Error, Result};
use crate::execution::Execution;
use crate::grid::Vec3;
use crate::processes::exchange::Team;
use crate::surface::halfedge::NONE;
use crate::surface::manifold::Surface;
use crate::tiles::seams::{along_axes, Point};
use crate::tiles::Place;

/// The lower and the upper corner of a box.
pub(crate) type Corners = [Vec3; 2];

/// Numbers that a point and a triangle are sent as, and those that precede them.
const POINT_LENGTH: usize = 4;
const TRIANGLE_LENGTH: usize = 3;
const HEAD_LENGTH: usize = 6;

/// One piece of a surface; a point's source is its part.
pub(crate) struct Piece {
    /// Which round and which tile made it.
    pub made_in: (usize, Place),
    pub surface: Surface,
}

impl Piece {
    /// Appends the piece as it is sent.
    fn pack(&self, message: &mut Vec<i64>) -> Result<()> {
        let (round, place) = self.made_in;
        let Surface {
            points,
            triangles,
            source,
        } = &self.surface;
        extend(
            message,
            [round, points.len(), triangles.len()].map(|n| n as i64),
        )?;
        extend(message, place.map(i64::from))?;
        for (p, part) in points.iter().zip(source) {
            let [x, y, z] = p.map(|v| v.to_bits() as i64);
            extend(message, [x, y, z, i64::from(*part)])?;
        }
        extend(message, triangles.iter().flatten().map(|&p| i64::from(p)))
    }

    /// The first of the pieces in a message, and the others.
    fn unpack(message: &[i64]) -> Result<(Self, &[i64])> {
        let (&[round, points, triangles, x, y, z], rest) = message
            .split_first_chunk::<HEAD_LENGTH>()
            .ok_or(Error::Pieces)?;
        let points = POINT_LENGTH * points as usize;
        let triangles = TRIANGLE_LENGTH * triangles as usize;
        let (points, rest) = rest.split_at_checked(points).ok_or(Error::Pieces)?;
        let (triangles, rest) = rest.split_at_checked(triangles).ok_or(Error::Pieces)?;
        let points = || points.chunks_exact(POINT_LENGTH);
        let place = |p: &[i64]| [p[0], p[1], p[2]].map(|bits| f64::from_bits(bits as u64));
        let corners = triangles.chunks_exact(TRIANGLE_LENGTH);
        let surface = Surface {
            points: collected(points().map(place))?,
            triangles: collected(corners.map(|t| [t[0], t[1], t[2]].map(|p| p as u32)))?,
            source: collected(points().map(|p| p[3] as u32))?,
        };
        let made_in = (round as usize, [x, y, z].map(|v| v as i32));
        Ok((Self { made_in, surface }, rest))
    }
}

/// What the pieces of other processes have in boxes of this one; `boxes` tells those of each process.
pub(crate) fn received(
    pieces: &[Piece],
    boxes: &[Vec<Corners>],
    team: &mut Team,
    execution: &Execution,
) -> Result<Vec<Piece>> {
    let mut messages = vec![Vec::new(); team.processes()];
    for (process, boxes) in boxes.iter().enumerate() {
        for piece in pieces.iter().filter(|_| process != team.process()) {
            let is_wanted = |p: Vec3| boxes.iter().any(|corners| is_within(*corners, p));
            let surface = chosen(&piece.surface, is_wanted, execution)?;
            if !surface.triangles.is_empty() {
                let made_in = piece.made_in;
                Piece { made_in, surface }.pack(&mut messages[process])?;
            }
        }
    }
    let mut found = Vec::new();
    for message in team.swap(messages)? {
        let mut left = &message[..];
        while !left.is_empty() {
            let (piece, rest) = Piece::unpack(left)?;
            push(&mut found, piece)?;
            left = rest;
        }
    }
    Ok(found)
}

/// The triangles of all pieces whose centres are in a box, as one surface.
pub(crate) fn gathered<'a>(
    pieces: impl IntoIterator<Item = &'a Piece>,
    corners: Corners,
    execution: &Execution,
) -> Result<Surface> {
    let mut order = collected(pieces)?;
    order.sort_unstable_by_key(|piece| piece.made_in);
    let mut found = Vec::new();
    for piece in order {
        let is_wanted = |p: Vec3| is_within(corners, p);
        push(&mut found, chosen(&piece.surface, is_wanted, execution)?)?;
    }
    joined(found, execution)
}

/// The centre of a triangle, to the bit the same whichever corner comes first.
pub(crate) fn centre(surface: &Surface, t: usize) -> Vec3 {
    let corners = surface.triangles[t].map(|p| surface.points[p as usize]);
    std::array::from_fn(|a| {
        let mut along = corners.map(|p| p[a]);
        along.sort_unstable_by(f64::total_cmp);
        along.iter().sum::<f64>() / 3.0
    })
}

/// Of each triangle of a surface whether its centre is wanted.
pub(crate) fn wanted(
    surface: &Surface,
    is_wanted: impl Fn(Vec3) -> bool + Sync,
    execution: &Execution,
) -> Result<Vec<bool>> {
    let mut wanted: Vec<bool> = zeros(surface.triangles.len())?;
    execution.in_pool(|| {
        let all = wanted.par_iter_mut().enumerate();
        all.for_each(|(t, own)| *own = is_wanted(centre(surface, t)));
    });
    Ok(wanted)
}

/// The triangles of a surface whose centres are wanted.
pub(crate) fn chosen(
    surface: &Surface,
    is_wanted: impl Fn(Vec3) -> bool + Sync,
    execution: &Execution,
) -> Result<Surface> {
    kept(surface, &wanted(surface, is_wanted, execution)?)
}

/// The triangles of a surface that stay, in their order, with their points.
pub(crate) fn kept(surface: &Surface, stays: &[bool]) -> Result<Surface> {
    let mut number = filled(NONE, surface.points.len())?;
    let mut used = Vec::new();
    // Pieces are kept for long: with as much room as they need.
    let mut triangles = reserved(stays.iter().filter(|stays| **stays).count())?;
    for (triangle, _) in surface.triangles.iter().zip(stays).filter(|(_, s)| **s) {
        for &p in triangle {
            if number[p as usize] == NONE {
                number[p as usize] = used.len() as u32;
                push(&mut used, p as usize)?;
            }
        }
        triangles.push(triangle.map(|p| number[p as usize]));
    }
    Ok(Surface {
        points: collected(used.iter().map(|&p| surface.points[p]))?,
        source: collected(used.iter().map(|&p| surface.source[p]))?,
        triangles,
    })
}

/// Several surfaces as one, in which points that are the same to the bit are one. Points are numbered by
/// part and place, and triangles come in the order of the surfaces.
fn joined(surfaces: impl IntoIterator<Item = Surface>, execution: &Execution) -> Result<Surface> {
    let mut all = Surface::default();
    for surface in surfaces {
        let first = all.points.len() as u32;
        extend(&mut all.points, surface.points)?;
        extend(&mut all.source, surface.source)?;
        let triangles = surface.triangles.iter().map(|t| t.map(|p| first + p));
        extend(&mut all.triangles, triangles)?;
    }
    let compare = |a: u32, b: u32| {
        let [a, b] = [a, b].map(|p| Point::of(&all, p as usize));
        a.order(&b)
    };
    let mut order = collected(0..all.points.len() as u32)?;
    execution.in_pool(|| order.par_sort_unstable_by(|&a, &b| compare(a, b)));
    let mut number: Vec<u32> = zeros(order.len())?;
    let (mut points, mut source) = (Vec::new(), Vec::new());
    for same in order.chunk_by(|&a, &b| compare(a, b).is_eq()) {
        same.iter()
            .for_each(|&p| number[p as usize] = points.len() as u32);
        push(&mut points, all.points[same[0] as usize])?;
        push(&mut source, all.source[same[0] as usize])?;
    }
    let corners = all.triangles.as_flattened_mut();
    execution.in_pool(|| {
        corners
            .par_iter_mut()
            .for_each(|p| *p = number[*p as usize])
    });
    (all.points, all.source) = (points, source);
    Ok(all)
}

/// The number of a point in a surface that was gathered.
pub(crate) fn number(gathered: &Surface, point: Point) -> Option<usize> {
    let Surface { points, source, .. } = gathered;
    let first = source.partition_point(|&part| part < point.part);
    let end = source.partition_point(|&part| part <= point.part);
    let of_part = &points[first..end];
    let found = of_part.binary_search_by(|p| along_axes(p, &point.place));
    found.ok().map(|at| first + at)
}

pub(crate) fn is_within([low, high]: Corners, p: Vec3) -> bool {
    (0..3).all(|a| low[a] <= p[a] && p[a] <= high[a])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::execution::Quiet;

    fn square(at: f64) -> Surface {
        let corner = |x: f64, y: f64| [at + x, y, 0.1];
        Surface {
            points: vec![
                corner(0.0, 0.0),
                corner(1.0, 0.0),
                corner(1.0, 1.0),
                corner(0.0, 1.0),
            ],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            source: vec![0; 4],
        }
    }

    #[test]
    fn what_is_joined_has_each_point_once() {
        let mut quiet = Quiet::default();
        let execution = &Execution::new(2, &mut quiet).unwrap();
        let both = joined([square(0.0), square(1.0)], execution).unwrap();
        assert_eq!(both.points.len(), 6);
        assert_eq!(both.triangles.len(), 4);
        let left = chosen(&both, |p| p[0] < 1.0, execution).unwrap();
        let right = chosen(&both, |p| p[0] >= 1.0, execution).unwrap();
        let again = joined([left, right], execution).unwrap();
        assert_eq!(again.points, both.points);
        assert_eq!(again.triangles, both.triangles);
        for (p, place) in both.points.iter().enumerate() {
            let point = |part| Point {
                part,
                place: *place,
            };
            assert_eq!(number(&both, point(0)), Some(p));
            assert_eq!(number(&both, point(1)), None);
        }
        let elsewhere = Point {
            part: 0,
            place: [0.5; 3],
        };
        assert_eq!(number(&both, elsewhere), None);
    }

    #[test]
    fn points_of_different_parts_are_different() {
        let mut other = square(1.0);
        other.source = vec![1; 4];
        let mut quiet = Quiet::default();
        let execution = &Execution::new(2, &mut quiet).unwrap();
        let both = joined([square(0.0), other], execution).unwrap();
        assert_eq!(both.points.len(), 8);
    }

    #[test]
    fn pieces_arrive_as_they_are_sent() {
        let mut message = Vec::new();
        let all = [(2, [1, -1, 3]), (0, [0; 3])];
        for made_in in all {
            let surface = square(f64::from(made_in.1[0]) / 3.0);
            Piece { made_in, surface }.pack(&mut message).unwrap();
        }
        let (first, rest) = Piece::unpack(&message).unwrap();
        let (second, rest) = Piece::unpack(rest).unwrap();
        assert!(rest.is_empty());
        for (piece, made_in) in [first, second].iter().zip(all) {
            assert_eq!(piece.made_in, made_in);
            let sent = square(f64::from(made_in.1[0]) / 3.0);
            assert_eq!(piece.surface.points, sent.points);
            assert_eq!(piece.surface.triangles, sent.triangles);
            assert_eq!(piece.surface.source, sent.source);
        }
        assert!(Piece::unpack(&message[..20]).is_err());
    }
}
