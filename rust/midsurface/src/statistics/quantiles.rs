//! Mean and quantiles of values of which each of several processes has some.
//!
//! No process gets the values of another one: a value of a given rank is found bit by bit, the highest
//! first, by how many values all have below.

use crate::error::{collected, extend, filled, push, Result};
use crate::processes::exchange::{taken, Team};
use crate::statistics::exact_sum::ExactSum;
use crate::statistics::ThicknessFigures;

/// Which quantiles.
const SHARES: [f64; 5] = [0.05, 0.25, 0.5, 0.75, 0.95];
/// The ranks between which they lie.
const RANKS: usize = 2 * SHARES.len();

/// The figures of several lists of finite values, of which all processes have to have as many; `None`
/// where nobody has a value.
pub(crate) fn thickness_figures(
    lists: Vec<Vec<f32>>,
    team: &mut Team,
) -> Result<Vec<Option<ThicknessFigures>>> {
    let totals = totals(&lists, team)?;
    let mut sorted = Vec::new();
    for list in lists {
        let mut keys = collected(list.into_iter().map(sortable))?;
        keys.sort_unstable();
        push(&mut sorted, keys)?;
    }
    let ranks = collected(totals.iter().map(|&(count, _)| ranks(count)))?;
    let ranked = ranked(&sorted, &ranks, team)?;
    let figures = |((count, sum), values): (&(usize, ExactSum), &[u32; RANKS])| {
        (*count > 0).then(|| ThicknessFigures {
            mean: sum.value() / *count as f64,
            quantiles: std::array::from_fn(|q| {
                let [below, above] = [2 * q, 2 * q + 1].map(|i| f64::from(of_sortable(values[i])));
                let place = place(*count, SHARES[q]);
                let t = place - place.floor();
                below * (1.0 - t) + above * t
            }),
        })
    };
    collected(totals.iter().zip(&ranked).map(figures))
}

/// How many values all processes have of each list, and their sum.
fn totals(lists: &[Vec<f32>], team: &mut Team) -> Result<Vec<(usize, ExactSum)>> {
    let mut message = Vec::new();
    for list in lists {
        extend(&mut message, [list.len() as i64])?;
        ExactSum::of(list.iter().copied().map(f64::from)).pack(&mut message)?;
    }
    let mut totals = filled((0, ExactSum::default()), lists.len())?;
    for message in team.share(&message)? {
        let mut rest = &message[..];
        for (count, sum) in &mut totals {
            let [of_process] = taken(&mut rest)?;
            *count += of_process as usize;
            sum.add_sum(&ExactSum::unpack(&mut rest)?);
        }
    }
    Ok(totals)
}

/// Where among so many ascending values a quantile lies.
fn place(count: usize, share: f64) -> f64 {
    share * (count - 1) as f64
}

/// The ranks of the values below and above each quantile.
fn ranks(count: usize) -> [usize; RANKS] {
    std::array::from_fn(|i| match count {
        0 => 0,
        _ => (place(count, SHARES[i / 2]).floor() as usize + i % 2).min(count - 1),
    })
}

/// The values of these ranks among those of all processes, given the own ones in order: the largest that
/// have no more values below them.
fn ranked(
    sorted: &[Vec<u32>],
    ranks: &[[usize; RANKS]],
    team: &mut Team,
) -> Result<Vec<[u32; RANKS]>> {
    let mut found = filled([0; RANKS], sorted.len())?;
    for bit in (0..u32::BITS).rev().map(|bit| 1 << bit) {
        let lists = sorted.iter().zip(&found);
        let below = lists.flat_map(|(list, values)| {
            values.map(|value| list.partition_point(|own| *own < value | bit) as i64)
        });
        let below = collected(below)?;
        let mut of_all: Vec<i64> = filled(0, below.len())?;
        for message in team.share(&below)? {
            let both = of_all.iter_mut().zip(message);
            both.for_each(|(sum, count)| *sum += count);
        }
        let values = found.as_flattened_mut().iter_mut();
        for ((value, rank), below) in values.zip(ranks.as_flattened()).zip(of_all) {
            if below <= *rank as i64 {
                *value |= bit;
            }
        }
    }
    Ok(found)
}

/// A number that sorts as the float does.
fn sortable(value: f32) -> u32 {
    let bits = value.to_bits();
    // Negative floats come first, in reverse.
    bits ^ if bits >> 31 == 1 { u32::MAX } else { 1 << 31 }
}

/// What [`sortable`] was made of.
fn of_sortable(key: u32) -> f32 {
    f32::from_bits(key ^ if key >> 31 == 1 { 1 << 31 } else { u32::MAX })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::processes::exchange::Alone;

    #[test]
    fn quantiles_lie_between_values() {
        let lists = vec![
            vec![4.0, -1.0, 0.0, 2.0, 3.0],
            Vec::new(),
            vec![f32::MAX],
            vec![2.5, 2.5],
        ];
        let mut alone = Alone;
        let found = thickness_figures(lists, &mut Team::new(&mut alone)).unwrap();
        let five = found[0].unwrap();
        assert_eq!(five.mean, 1.6);
        assert_eq!(five.quantiles[1..4], [0.0, 2.0, 3.0]);
        assert!((five.quantiles[0] + 0.8).abs() < 1e-12, "{five:?}");
        assert!((five.quantiles[4] - 3.8).abs() < 1e-12, "{five:?}");
        assert_eq!(found[1], None);
        assert_eq!(found[2].unwrap().quantiles, [f64::from(f32::MAX); 5]);
        assert_eq!(found[3].unwrap().quantiles, [2.5; 5]);
    }
}
