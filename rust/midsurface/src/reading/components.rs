//! Stage 2, runs → parts: which voxels belong together.
//!
//! A *component* is what a user sees as one object: voxels of one label connected through faces,
//! edges or corners (26 neighbours). A *part* is what one blur may see: voxels connected through
//! faces (6 neighbours), since two sheets one voxel apart touch at corners. Sheets of a single
//! voxel are held together by corners only, so thin parts that touch are one part.

use crate::error::{check_count, collected, filled, push, zeros, Result};
use crate::execution::Execution;
use crate::reading::runs::Run;

/// Components of fewer voxels are specks of noise, not membranes.
pub(crate) const SPECK: usize = 30;

/// So many runs tell whether a part is thin.
const MOST_LOOKED_AT: usize = 4096;

/// A set of runs of one label that one blur may see, ordered by z, y, x.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Part {
    pub label: i64,
    /// Number of the component, as in [`crate::Mesh::components`].
    pub component: u32,
    pub runs: Vec<Run>,
}

impl Part {
    /// Number of labelled voxels.
    pub fn voxels(&self) -> usize {
        self.runs.iter().map(Run::length).sum()
    }
}

/// Disjoint sets of indices; the smallest index of a set stands for it.
pub(crate) struct DisjointSets(Vec<u32>);

impl DisjointSets {
    pub fn new(count: usize) -> Result<Self> {
        Ok(Self(collected(0..count as u32)?))
    }

    pub fn find(&mut self, mut i: usize) -> usize {
        while self.0[i] as usize != i {
            self.0[i] = self.0[self.0[i] as usize];
            i = self.0[i] as usize;
        }
        i
    }

    pub fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.find(a), self.find(b));
        self.0[a.max(b)] = a.min(b) as u32;
    }
}

/// The parts of all labels, ordered by component, and the number of specks left out.
pub(crate) fn parts(mut runs: Vec<Run>, execution: &mut Execution) -> Result<(Vec<Part>, usize)> {
    check_count("rows of labelled voxels", runs.len(), 1)?;
    sort_by_label(&mut runs);
    let mut parts = Vec::new();
    let (mut specks, mut components) = (0, 0);
    let total = runs.len();
    let mut done = 0;
    for runs in runs.chunk_by(|a, b| a.label == b.label) {
        specks += parts_of_label(runs, &mut components, &mut parts)?;
        done += runs.len();
        execution.report(done as f64 / total as f64)?;
    }
    Ok((parts, specks))
}

/// Orders runs by label, then by z, y, x. A stable sort by label alone would ask for memory.
pub(crate) fn sort_by_label(runs: &mut [Run]) {
    runs.sort_unstable_by_key(|run| (run.label, run.z, run.y, run.start));
}

/// The 26-connected sets of the runs of one label.
pub(crate) fn connected(runs: &[Run]) -> Result<DisjointSets> {
    let mut sets = DisjointSets::new(runs.len())?;
    for_each_touch(runs, |a, b, _| {
        sets.join(a, b);
        Ok(())
    })?;
    Ok(sets)
}

/// Appends one label's parts and returns its number of specks.
fn parts_of_label(runs: &[Run], components: &mut u32, parts: &mut Vec<Part>) -> Result<usize> {
    let mut whole = DisjointSets::new(runs.len())?;
    let mut faces = DisjointSets::new(runs.len())?;
    let mut corners = Vec::new();
    for_each_touch(runs, |a, b, share_a_face| {
        whole.join(a, b);
        if share_a_face {
            faces.join(a, b);
            Ok(())
        } else {
            push(&mut corners, (a, b))
        }
    })?;
    corners.retain(|&(a, b)| faces.find(a) != faces.find(b));
    join_thin(runs, &corners, &mut faces)?;

    let (order, specks) = components_by_size(runs, &mut whole)?;
    let mut number = filled(u32::MAX, runs.len())?;
    for (i, &root) in order.iter().enumerate() {
        number[root] = *components + i as u32;
    }
    *components += order.len() as u32;

    let first = parts.len();
    let mut part_of_root = filled(u32::MAX, runs.len())?;
    for (i, run) in runs.iter().enumerate() {
        let component = number[whole.find(i)];
        if component == u32::MAX {
            continue;
        }
        let part = &mut part_of_root[faces.find(i)];
        if *part == u32::MAX {
            *part = parts.len() as u32;
            let empty = Part {
                label: run.label,
                component,
                runs: Vec::new(),
            };
            push(parts, empty)?;
        }
        push(&mut parts[*part as usize].runs, *run)?;
    }
    // What hangs on by a corner and is no larger than a speck is noise, too.
    let mut own = first;
    for i in first..parts.len() {
        if parts[i].voxels() >= SPECK {
            parts.swap(own, i);
            own += 1;
        }
    }
    parts.truncate(own);
    // Parts of one component stay in the order of their first voxels.
    let place = |run: &Run| (run.z, run.y, run.start);
    parts[first..].sort_unstable_by_key(|part| (part.component, place(&part.runs[0])));
    Ok(specks)
}

/// Roots of the components that are not specks, the largest first, and the number of specks.
fn components_by_size(runs: &[Run], sets: &mut DisjointSets) -> Result<(Vec<usize>, usize)> {
    let mut sizes: Vec<usize> = zeros(runs.len())?;
    for (i, run) in runs.iter().enumerate() {
        sizes[sets.find(i)] += run.length();
    }
    let all = sizes.iter().filter(|size| **size > 0).count();
    let mut roots = collected((0..runs.len()).filter(|&i| sizes[i] >= SPECK))?;
    // Equal sizes: the one met first in the volume comes first.
    roots.sort_unstable_by_key(|&i| (std::cmp::Reverse(sizes[i]), i));
    let specks = all - roots.len();
    Ok((roots, specks))
}

/// Joins parts that touch at edges or corners, `corners`, where both are a single voxel thick.
fn join_thin(runs: &[Run], corners: &[(usize, usize)], faces: &mut DisjointSets) -> Result<()> {
    // Only the parts that do touch are looked at: thin voxels less thick ones, 0 for the others.
    let mut touching: Vec<bool> = zeros(runs.len())?;
    for &(a, b) in corners {
        touching[faces.find(a)] = true;
        touching[faces.find(b)] = true;
    }
    let row_of = RowIndex::new(runs)?;
    let mut thin: Vec<i64> = zeros(runs.len())?;
    let mut looked_at: Vec<usize> = zeros(runs.len())?;
    for (i, run) in runs.iter().enumerate() {
        let root = faces.find(i);
        looked_at[root] += 1;
        if touching[root] && looked_at[root] <= MOST_LOOKED_AT {
            let is_thin = |x: &u32| run.length() == 1 || row_of.alone(runs, run, *x);
            let count = (run.start..run.end).filter(is_thin).count() as i64;
            thin[root] += 2 * count - run.length() as i64;
        }
    }
    let is_thin = collected((0..runs.len()).map(|i| thin[faces.find(i)] >= 0))?;
    for &(a, b) in corners {
        if is_thin[a] && is_thin[b] {
            faces.join(a, b);
        }
    }
    Ok(())
}

/// Finds the runs of a row.
struct RowIndex {
    /// First run of each row (z, y) that has one, with a sentinel at the end.
    starts: Vec<usize>,
    rows: Vec<(u32, u32)>,
}

impl RowIndex {
    fn new(runs: &[Run]) -> Result<Self> {
        let mut starts = Vec::new();
        let mut rows: Vec<(u32, u32)> = Vec::new();
        for (i, run) in runs.iter().enumerate() {
            if rows.last() != Some(&(run.z, run.y)) {
                push(&mut rows, (run.z, run.y))?;
                push(&mut starts, i)?;
            }
        }
        push(&mut starts, runs.len())?;
        Ok(Self { starts, rows })
    }

    /// The range of runs in row (z, y).
    fn row(&self, z: u32, y: u32) -> std::ops::Range<usize> {
        match self.rows.binary_search(&(z, y)) {
            Ok(i) => self.starts[i]..self.starts[i + 1],
            Err(_) => 0..0,
        }
    }

    fn labelled(&self, runs: &[Run], x: u32, y: Option<u32>, z: Option<u32>) -> bool {
        let (Some(y), Some(z)) = (y, z) else {
            return false;
        };
        let row = &runs[self.row(z, y)];
        let after = row.partition_point(|run| run.start <= x);
        after > 0 && x < row[after - 1].end
    }

    /// Whether voxel x of `run` has background on both sides along y or along z.
    fn alone(&self, runs: &[Run], run: &Run, x: u32) -> bool {
        let (y, z) = (run.y, run.z);
        let along_y = || {
            self.labelled(runs, x, y.checked_sub(1), Some(z))
                || self.labelled(runs, x, y.checked_add(1), Some(z))
        };
        let along_z = || {
            self.labelled(runs, x, Some(y), z.checked_sub(1))
                || self.labelled(runs, x, Some(y), z.checked_add(1))
        };
        !along_y() || !along_z()
    }
}

/// Calls `touch(a, b, share_a_face)` for all pairs of runs that are 26-neighbours.
pub(crate) fn for_each_touch(
    runs: &[Run],
    mut touch: impl FnMut(usize, usize, bool) -> Result<()>,
) -> Result<()> {
    let index = RowIndex::new(runs)?;
    for (i, &(z, y)) in index.rows.iter().enumerate() {
        let row = index.starts[i]..index.starts[i + 1];
        let before = [
            (y.checked_sub(1), Some(z), true),
            (y.checked_sub(1), z.checked_sub(1), false),
            (Some(y), z.checked_sub(1), true),
            (Some(y + 1), z.checked_sub(1), false),
        ];
        for (y, z, shares_face) in before {
            if let (Some(y), Some(z)) = (y, z) {
                touching(runs, row.clone(), index.row(z, y), |a, b, overlap| {
                    touch(a, b, shares_face && overlap)
                })?;
            }
        }
    }
    Ok(())
}

/// Walks two rows side by side and calls `touch(a, b, overlap)` for runs that overlap or follow each
/// other.
pub(crate) fn touching(
    runs: &[Run],
    mut a: std::ops::Range<usize>,
    mut b: std::ops::Range<usize>,
    mut touch: impl FnMut(usize, usize, bool) -> Result<()>,
) -> Result<()> {
    while !a.is_empty() && !b.is_empty() {
        let (p, q) = (&runs[a.start], &runs[b.start]);
        if p.start <= q.end && q.start <= p.end {
            touch(a.start, b.start, p.start < q.end && q.start < p.end)?;
        }
        if p.end < q.end {
            a.start += 1;
        } else {
            b.start += 1;
        }
    }
    Ok(())
}
