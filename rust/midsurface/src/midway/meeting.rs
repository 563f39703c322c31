//! What blind rims see ahead → where they end: on a smooth curve, along which sheets meet.
//!
//! A blind rim (`reach.rs`) is as jagged as the contour, and each of its points sees what lies across its own
//! way. The line where membranes meet is smooth: the places that are seen are averaged along the rim, so
//! that what is led on neither fans out nor folds where the rim has a step. A few points that see nothing
//! take over what those beside them see. On the border of the volume, where the last point has no other
//! beyond it to average with, the curve goes on straight.

use crate::error::{collected, Result};
use crate::grid::{along, sub, Vec3};
use crate::midway::reach::{Blind, WAY_ROUNDS};

/// How far before what it sees a rim ends, work units.
const APART: f64 = 0.1;
/// So many points along a rim take over what those beside them see.
const TAKEN_OVER: usize = 3;
/// Times that the curve is averaged.
const ROUNDS: usize = 12;
/// So many points next to the border of the volume the curve is straight, going on as it does over the
/// same number of points before, by no more than so many times that way.
const STRAIGHT: usize = 3;
const FARTHEST: f64 = 1.5;

/// Where each point of the blind rims ends that sees another sheet so far ahead, or is near one that does.
pub(crate) fn ends(blind: &[Blind], seen: &[Option<f64>]) -> Result<Vec<Option<Vec3>>> {
    let mut ends = collected((0..blind.len()).map(|b| own_end(blind, seen, b)))?;
    for _ in 0..TAKEN_OVER {
        let before = collected(ends.iter().copied())?;
        for (own, end) in blind.iter().zip(&mut ends).filter(|(_, end)| end.is_none()) {
            let told = own.beside.map(|b| {
                let other = &blind[b?];
                Some(along(before[b?]?, 1.0, sub(own.place, other.place)))
            });
            *end = match told {
                [Some(a), Some(b)] => Some(midway(a, b)),
                [a, b] => a.or(b),
            };
        }
    }
    let of_border = |b: &usize| blind[*b].on_border.contains(&true);
    let on_border = collected((0..blind.len()).filter(of_border))?;
    let alone = collected(on_border.iter().map(|&b| ends[b].take()))?;
    for _ in 0..ROUNDS {
        let before = collected(ends.iter().copied())?;
        for (own, end) in blind.iter().zip(&mut ends) {
            let beside = own.beside.map(|b| before[b?]);
            if let ([Some(a), Some(b)], Some(own_end)) = (beside, *end) {
                *end = Some(midway(own_end, midway(a, b)));
            }
        }
    }
    for (b, alone) in on_border.into_iter().zip(alone) {
        if lead_to_border(blind, &mut ends, b).is_none() {
            ends[b] = alone;
        }
    }
    Ok(ends)
}

/// Where a point ends by what it sees itself. What it sees alone is nothing to go by, and a tear goes nowhere.
fn own_end(blind: &[Blind], seen: &[Option<f64>], b: usize) -> Option<Vec3> {
    let own = &blind[b];
    let is_alone = own.beside.iter().flatten().all(|&b| seen[b].is_none());
    let far = seen[b].filter(|_| !is_alone && !is_of_tear(blind, b))?;
    Some(along(own.place, (far - APART).max(0.0), own.way))
}

fn midway(a: Vec3, b: Vec3) -> Vec3 {
    along(a, 0.5, sub(b, a))
}

/// Whether the rim of a point comes back to it within as many points as ways are averaged over.
fn is_of_tear(blind: &[Blind], b: usize) -> bool {
    let mut at = b;
    for _ in 0..2 * WAY_ROUNDS {
        match blind[at].beside[1] {
            Some(after) if after == b => return true,
            Some(after) => at = after,
            None => return false,
        }
    }
    false
}

/// Leads the curve on straight to the border of the volume, on which a rim has its last point; `None` where
/// it is too short, or runs along the border.
fn lead_to_border(blind: &[Blind], ends: &mut [Option<Vec3>], last: usize) -> Option<()> {
    let own = &blind[last];
    let axis = own.on_border.iter().position(|on| *on)?;
    let side = usize::from(own.beside[0].is_none());
    let mut chain = [last; 2 * STRAIGHT + 1];
    for k in 1..chain.len() {
        chain[k] = blind[chain[k - 1]].beside[side]?;
    }
    let (near, far) = (ends[chain[STRAIGHT]]?, ends[chain[2 * STRAIGHT]]?);
    let step = sub(near, far);
    let share = (own.place[axis] - near[axis]) / step[axis];
    if !(0.0..=FARTHEST).contains(&share) {
        return None;
    }
    let end = own.on_same_border(along(near, share, step));
    for (k, &b) in chain[..STRAIGHT].iter().enumerate() {
        ends[b] = Some(along(end, k as f64 / STRAIGHT as f64, sub(near, end)));
    }
    Some(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A rim along x in z = 0 whose points look along z.
    fn rim(points: &[[f64; 2]]) -> Vec<Blind> {
        let point = |(b, &[x, z]): (usize, &[f64; 2])| Blind {
            point: b as u32,
            beside: [b.checked_sub(1), Some(b + 1).filter(|b| *b < points.len())],
            on_border: [false; 3],
            place: [x, 0.0, z],
            way: [0.0, 0.0, 1.0],
        };
        points.iter().enumerate().map(point).collect()
    }

    fn ring(count: usize) -> Vec<Blind> {
        let mut blind = rim(&vec![[0.0; 2]; count]);
        blind[0].beside[0] = Some(count - 1);
        blind[count - 1].beside[1] = Some(0);
        blind
    }

    #[test]
    fn the_rim_of_a_tear_goes_nowhere_and_that_of_a_sheet_goes_on() {
        let long = 2 * WAY_ROUNDS + 1;
        assert_eq!(ends(&ring(8), &[Some(1.0); 8]).unwrap(), [None; 8]);
        let on = ends(&ring(long), &vec![Some(1.0); long]).unwrap();
        assert!(on.iter().all(Option::is_some));
        // A short rim that ends at two others is none of a tear.
        let open = ends(&rim(&[[0.0; 2]; 8]), &[Some(1.0); 8]).unwrap();
        assert!(open.iter().all(Option::is_some));
    }

    #[test]
    fn a_jagged_rim_ends_on_a_straight_line() {
        let jagged = |x: usize| [x as f64, if x % 7 < 3 { 0.0 } else { 1.5 }];
        let blind = rim(&(0..30).map(jagged).collect::<Vec<_>>());
        let seen: Vec<_> = blind.iter().map(|b| Some(4.0 - b.place[2])).collect();
        for end in ends(&blind, &seen).unwrap() {
            assert!((end.unwrap()[2] - (4.0 - APART)).abs() < 1e-9);
        }
    }

    #[test]
    fn few_points_that_see_nothing_take_over_what_is_seen_beside_them_and_many_do_not() {
        let blind = rim(&(0..40).map(|x| [x as f64, 0.0]).collect::<Vec<_>>());
        let unseen = |from: usize, to: usize| {
            let seen = (0..40).map(|b| Some(2.0).filter(|_| !(from..to).contains(&b)));
            ends(&blind, &seen.collect::<Vec<_>>()).unwrap()
        };
        assert!(unseen(10, 10 + 2 * TAKEN_OVER).iter().all(Option::is_some));
        let wide = unseen(10, 30);
        assert!(wide[9 + TAKEN_OVER].is_some() && wide[10 + TAKEN_OVER].is_none());
        // What one alone sees does not count.
        let alone: Vec<_> = (0..40).map(|b| Some(2.0).filter(|_| b == 20)).collect();
        assert_eq!(ends(&blind, &alone).unwrap(), [None; 40]);
    }

    #[test]
    fn the_curve_goes_on_straight_to_the_border() {
        let mut blind = rim(&(0..20).map(|x| [x as f64, 0.0]).collect::<Vec<_>>());
        blind[0].on_border[0] = true;
        let mut seen: Vec<_> = (0..20).map(|x| Some(2.0 + 0.1 * f64::from(x))).collect();
        seen[0] = Some(5.0);
        let found = ends(&blind, &seen).unwrap();
        let [x, _, z] = found[0].unwrap();
        assert!(x == 0.0 && (z - 2.0 + APART).abs() < 0.1, "{x} {z}");
    }
}
