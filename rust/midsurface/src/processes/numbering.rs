//! Numbers of points and triangles among those of all processes.
//!
//! Where a component was worked on in tiles several processes may have a point: the first of them numbers
//! it, and the others learn its number.

use crate::error::{collected, extend, filled, push, reserved, Result};
use crate::processes::exchange::Team;

/// Tells a point that other processes may have, too: its component, its part, and its place to the bit.
pub(crate) type Key = [i64; 5];

/// Stands for the number of a point that has none yet.
const NONE: i64 = -1;

/// The first of each process's things among those of all, given how many are its own.
pub(crate) fn first_of_own(count: usize, team: &mut Team) -> Result<i64> {
    let of_all = team.share(&[count as i64])?;
    Ok(of_all.iter().take(team.process()).flatten().sum())
}

fn chunks<const N: usize>(mut left: &[i64]) -> impl Iterator<Item = [i64; N]> + '_ {
    std::iter::from_fn(move || {
        let (chunk, rest) = left.split_first_chunk()?;
        left = rest;
        Some(*chunk)
    })
}

/// The numbers of this process's points, of which `shared` ones others may have, too.
pub(crate) fn point_ids(count: usize, shared: &[(Key, u32)], team: &mut Team) -> Result<Vec<i64>> {
    let keys = collected(shared.iter().flat_map(|(key, _)| *key))?;
    let mut earlier: Vec<Key> = Vec::new();
    for message in team.share(&keys)?.iter().take(team.process()) {
        extend(&mut earlier, chunks(message))?;
    }
    earlier.sort_unstable();
    let is_own = |key: &Key| earlier.binary_search(key).is_err();
    let mut is_others = filled(false, count)?;
    for (_, p) in shared.iter().filter(|(key, _)| !is_own(key)) {
        is_others[*p as usize] = true;
    }
    let others = is_others.iter().filter(|others| **others).count();
    let mut next = first_of_own(count - others, team)?;
    let mut ids = reserved(count)?;
    for others in is_others {
        ids.push(if others { NONE } else { next });
        next += i64::from(!others);
    }
    let mut numbered = Vec::new();
    for (key, p) in shared.iter().filter(|(key, _)| is_own(key)) {
        extend(&mut numbered, *key)?;
        push(&mut numbered, ids[*p as usize])?;
    }
    let mut known: Vec<[i64; 6]> = Vec::new();
    for message in team.share(&numbered)? {
        extend(&mut known, chunks::<6>(&message))?;
    }
    known.sort_unstable();
    for (key, p) in shared.iter().filter(|(key, _)| !is_own(key)) {
        let at = known.partition_point(|known| known[..5] < key[..]);
        ids[*p as usize] = known[at][5];
    }
    Ok(ids)
}
