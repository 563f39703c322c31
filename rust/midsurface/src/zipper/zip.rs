//! Stage 6, mid-polylines → triangles: neighbouring slices are zipped together.
//!
//! Two edges in neighbouring slices are a pair where each is the other's nearest by midpoint
//! (MidSurfer, section "Polyline Zipper"). Successive pairs along two lines are linked to a strip,
//! with the edges between them that found no partner. Every edge of a line is in one strip upward
//! and one downward at most, and a strip is triangulated by its shortest diagonals, so that no
//! edge of the mesh has more than two triangles, whatever the lines are.
//!
//! Pairs farther apart than the label is thick there are of different sheets and stay apart, as
//! do edges much farther apart than the pairs of their strip on average: gaps remain gaps.

use rstar::primitives::GeomWithData;
use rstar::RTree;

use crate::error::{collected, extend, push, reserved, zeros, Error, Result};
use crate::execution::Execution;
use crate::grid::{dot, length, squared_distance, sub, Vec3};
use crate::zipper::polylines::{Polyline, Polylines};
use crate::zipper::strip::{triangulate, Side};

/// The most edges without a partner at the end of a strip.
const GAP: usize = 4;
/// The most edges without a partner between two linked pairs. Where lines are displaced by more than
/// an edge, each edge's nearest prefers the next one, all along.
const FREE: i64 = 64;
/// An edge without a partner may be farther away than its strip's pairs by this factor.
const FARTHER: f64 = 1.8;
/// The most edges that end a strip where both lines leave the volume. At a small angle to its border
/// the one goes on for long where the other has left: with five edges, at 8°.
const LEAVING: i64 = 16;
/// A point is on the border where it is nearer to it than this share of an edge.
const ON_BORDER: f64 = 1e-2;
/// Relative difference below which two lengths are the same: a change of units costs a last bit.
pub(crate) const SAME: f64 = 1e-7;

/// Passes over the slices that [`zip`] makes, for its progress.
pub(crate) const PASSES: usize = 2;

/// A triangle of point indices, with the line it stands on, which knows label and component.
pub(crate) type Zipped = ([u32; 3], u32);

/// An edge of a line.
#[derive(Clone, Copy)]
struct Edge {
    line: u32,
    /// Position along the line: from point `at` to the next.
    at: u32,
    middle: Vec3,
    direction: Vec3,
    thickness: f64,
}

/// The lines of one component in one slice, as edges; those of a line follow each other.
struct SliceEdges<'a> {
    polylines: &'a Polylines,
    edges: Vec<Edge>,
    tree: RTree<GeomWithData<Vec3, u32>>,
}

/// Zips all neighbouring slices. Triangles come ordered by component and slice.
pub(crate) fn zip(polylines: &Polylines, execution: &mut Execution) -> Result<Vec<Zipped>> {
    // Two triangles a point make six half-edges, numbered in 32 bits.
    if polylines.points.len() > (u32::MAX as usize - 1) / 8 {
        return Err(Error::Polylines(format!(
            "{} points are more than a mesh of 32-bit indices can hold",
            polylines.points.len()
        )));
    }
    let mut order = collected(0..polylines.lines.len() as u32)?;
    let key = |i: &u32| {
        let line = &polylines.lines[*i as usize];
        (line.label, line.component, line.slice)
    };
    order.sort_unstable_by_key(|i| (key(i), *i));
    let groups = collected(order.chunk_by(|a, b| key(a) == key(b)))?;
    let are_neighbours = |&i: &usize| {
        let (a, b) = (key(&groups[i - 1][0]), key(&groups[i][0]));
        (a.0, a.1) == (b.0, b.1) && a.2.checked_add(1) == Some(b.2)
    };
    let neighbours = collected((1..groups.len()).filter(are_neighbours))?;
    let mut slices = reserved(groups.len())?;
    execution.stream(
        &groups,
        |group| SliceEdges::new(polylines, group),
        |edges| {
            slices.push(edges?);
            Ok(())
        },
    )?;
    let mut triangles = Vec::new();
    execution.stream(
        &neighbours,
        |&i| zip_slices(&slices[i - 1], &slices[i]),
        |found: Result<Vec<Zipped>>| extend(&mut triangles, found?),
    )?;
    Ok(triangles)
}

/// The index of the point after point `at` of a line, going round a closed one.
fn point(line: &Polyline, at: i64) -> u32 {
    let n = line.count as i64;
    let at = if line.closed {
        at.rem_euclid(n)
    } else {
        at.clamp(0, n - 1)
    };
    (line.first as i64 + at) as u32
}

/// Number of edges of a line.
fn edge_count(line: &Polyline) -> usize {
    if line.closed {
        line.count
    } else {
        line.count.saturating_sub(1)
    }
}

impl<'a> SliceEdges<'a> {
    fn new(polylines: &'a Polylines, lines: &[u32]) -> Result<Self> {
        let mut edges = Vec::new();
        for &number in lines {
            let line = &polylines.lines[number as usize];
            for at in 0..edge_count(line) {
                let [p, q] = [at, at + 1].map(|i| point(line, i as i64) as usize);
                let (a, b) = (polylines.points[p], polylines.points[q]);
                let thick = 0.5 * (polylines.thickness[p] + polylines.thickness[q]);
                let edge = Edge {
                    line: number,
                    at: at as u32,
                    middle: std::array::from_fn(|k| 0.5 * (a[k] + b[k])),
                    direction: crate::grid::unit(sub(b, a)),
                    thickness: thick.into(),
                };
                push(&mut edges, edge)?;
            }
        }
        let indexed = edges.iter().enumerate();
        let indexed = indexed.map(|(i, edge)| GeomWithData::new(edge.middle, i as u32));
        let tree = RTree::bulk_load(collected(indexed)?);
        Ok(Self {
            polylines,
            edges,
            tree,
        })
    }

    fn line(&self, edge: usize) -> &'a Polyline {
        &self.polylines.lines[self.edges[edge].line as usize]
    }

    /// The nearest edge of the other slice to each edge.
    fn nearest(&self, other: &Self) -> Result<Vec<usize>> {
        collected(self.edges.iter().map(|edge| {
            let found = other.tree.nearest_neighbor(&edge.middle);
            found.map_or(usize::MAX, |nearest| nearest.data as usize)
        }))
    }

    /// The edge `steps` after `edge` on its line, `None` beyond an end.
    fn step(&self, edge: usize, steps: i64) -> Option<usize> {
        let line = self.line(edge);
        let at = i64::from(self.edges[edge].at);
        let n = edge_count(line) as i64;
        let target = if line.closed {
            (at + steps).rem_euclid(n)
        } else {
            at + steps
        };
        (0..n)
            .contains(&target)
            .then(|| (edge as i64 - at + target) as usize)
    }

    /// Edges beyond `edge` where its line ends on the border of the volume.
    fn edges_to_border(&self, edge: usize, sign: i64) -> Option<i64> {
        let line = self.line(edge);
        let at = i64::from(self.edges[edge].at);
        let last = edge_count(line) as i64 - 1;
        let (count, [before, end]) = if sign > 0 {
            (last - at, [last, last + 1])
        } else {
            (at, [1, 0])
        };
        let [before, end] = [before, end].map(|i| point(line, i) as usize);
        let edge = length(sub(
            self.polylines.points[before],
            self.polylines.points[end],
        ));
        let is_on_border = f64::from(self.polylines.border_distance[end]) < ON_BORDER * edge;
        (!line.closed && is_on_border).then_some(count)
    }

    /// Steps along the line from edge a to edge b of the same line; the shorter way round.
    fn steps(&self, a: usize, b: usize) -> i64 {
        let line = self.line(a);
        let steps = i64::from(self.edges[b].at) - i64::from(self.edges[a].at);
        let n = edge_count(line) as i64;
        if !line.closed {
            steps
        } else {
            (steps + n / 2).rem_euclid(n) - n / 2
        }
    }
}

/// A stretch of linked pairs: consecutive edges on both lines, the second one walked forward or
/// backward.
struct Chain {
    pairs: Vec<(usize, usize)>,
    forward: bool,
    /// All pairs of two closed lines, all the way round.
    round: bool,
}

/// What is known of the edges of two neighbouring slices while they are zipped.
struct Pairing<'a> {
    below: &'a SliceEdges<'a>,
    above: &'a SliceEdges<'a>,
    nearest_above: Vec<usize>,
    nearest_below: Vec<usize>,
    /// Partner of each edge below, and whether an edge above has one.
    partner: Vec<Option<usize>>,
    taken_above: Vec<bool>,
    taken_below: Vec<bool>,
}

fn zip_slices(below: &SliceEdges, above: &SliceEdges) -> Result<Vec<Zipped>> {
    if below.edges.is_empty() || above.edges.is_empty() {
        return Ok(Vec::new());
    }
    let mut pairing = Pairing::new(below, above)?;
    let mut triangles = Vec::new();
    for chain in pairing.chains() {
        let sides = pairing.extended(&chain);
        let line = below.edges[chain.pairs[0].0].line;
        let strip = triangulate(&below.polylines.points, &sides[0], &sides[1]);
        extend(
            &mut triangles,
            strip.into_iter().map(|triangle| (triangle, line)),
        )?;
    }
    Ok(triangles)
}

impl<'a> Pairing<'a> {
    fn new(below: &'a SliceEdges<'a>, above: &'a SliceEdges<'a>) -> Result<Self> {
        let nearest_above = below.nearest(above)?;
        let nearest_below = above.nearest(below)?;
        let partner = collected((0..below.edges.len()).map(|a| {
            let b = nearest_above[a];
            let (p, q) = (&below.edges[a], &above.edges[b]);
            let mutual = nearest_below[b] == a;
            let gap = length(sub(p.middle, q.middle));
            let thick = p.thickness.max(q.thickness);
            // Lines of one sheet run side by side and within the label.
            let aligned = dot(p.direction, q.direction).abs() > 0.3;
            (mutual && aligned && gap <= reach(below, a, thick)).then_some(b)
        }))?;
        let mut taken_above: Vec<bool> = zeros(above.edges.len())?;
        for &b in partner.iter().flatten() {
            taken_above[b] = true;
        }
        let taken_below = collected(partner.iter().map(Option::is_some))?;
        Ok(Self {
            below,
            above,
            nearest_above,
            nearest_below,
            partner,
            taken_above,
            taken_below,
        })
    }

    fn distance(&self, a: usize, b: usize) -> f64 {
        squared_distance(self.below.edges[a].middle, self.above.edges[b].middle).sqrt()
    }

    /// Whether the edges of a pair run the same way.
    fn same_way(&self, (a, b): (usize, usize)) -> bool {
        dot(self.below.edges[a].direction, self.above.edges[b].direction) > 0.0
    }

    /// Whether pair `q` follows pair `p` on both lines, with edges between them that have no
    /// partner but whose nearest edges lie between the pairs, too.
    fn linked(&self, p: (usize, usize), q: (usize, usize)) -> bool {
        let same_lines = self.below.edges[p.0].line == self.below.edges[q.0].line
            && self.above.edges[p.1].line == self.above.edges[q.1].line;
        if !same_lines || self.same_way(p) != self.same_way(q) {
            return false;
        }
        let sign = if self.same_way(p) { 1 } else { -1 };
        let below = self.below.steps(p.0, q.0);
        let above = sign * self.above.steps(p.1, q.1);
        if !(1..=FREE).contains(&below) || !(1..=FREE).contains(&above) {
            return false;
        }
        let between_above = |b: usize| {
            self.above.edges[b].line == self.above.edges[p.1].line
                && (-1..=above + 1).contains(&(sign * self.above.steps(p.1, b)))
        };
        let between_below = |a: usize| {
            self.below.edges[a].line == self.below.edges[p.0].line
                && (-1..=below + 1).contains(&self.below.steps(p.0, a))
        };
        (1..below)
            .filter_map(|k| self.below.step(p.0, k))
            .all(|a| between_above(self.nearest_above[a]))
            && (1..above)
                .filter_map(|k| self.above.step(p.1, sign * k))
                .all(|b| !self.taken_above[b] && between_below(self.nearest_below[b]))
    }

    /// All chains, in the order of the edges below.
    fn chains(&self) -> Vec<Chain> {
        let pairs: Vec<(usize, usize)> = (0..self.partner.len())
            .filter_map(|a| self.partner[a].map(|b| (a, b)))
            .collect();
        let mut chains = Vec::new();
        for pairs in pairs.chunk_by(|p, q| self.below.edges[p.0].line == self.below.edges[q.0].line)
        {
            self.chains_of_line(pairs, &mut chains);
        }
        chains
    }

    /// Cuts the pairs of one line below into chains.
    fn chains_of_line(&self, pairs: &[(usize, usize)], chains: &mut Vec<Chain>) {
        let chain = |pairs: Vec<(usize, usize)>, round| Chain {
            forward: self.same_way(pairs[0]),
            pairs,
            round,
        };
        let closed = self.below.line(pairs[0].0).closed;
        let last = pairs.len() - 1;
        let wraps = closed && pairs.len() > 2 && self.linked(pairs[last], pairs[0]);
        let breaks: Vec<usize> = (1..pairs.len())
            .filter(|&i| !self.linked(pairs[i - 1], pairs[i]))
            .collect();
        if wraps && breaks.is_empty() {
            chains.push(chain(pairs.to_vec(), self.goes_round(pairs)));
            return;
        }
        let mut bounds = vec![0];
        bounds.extend(&breaks);
        bounds.push(pairs.len());
        let mut pieces: Vec<Vec<_>> = bounds
            .windows(2)
            .map(|w| pairs[w[0]..w[1]].to_vec())
            .collect();
        if wraps {
            // The line's first point lies within a chain: join its two pieces.
            let first = pieces.remove(0);
            if let Some(tail) = pieces.last_mut() {
                tail.extend(first);
            }
        }
        chains.extend(pieces.into_iter().map(|piece| chain(piece, false)));
    }

    /// Whether linked pairs go once round both lines.
    fn goes_round(&self, pairs: &[(usize, usize)]) -> bool {
        let turn = |steps: &dyn Fn(usize, usize) -> i64| -> i64 {
            (0..pairs.len())
                .map(|i| steps(i, (i + 1) % pairs.len()))
                .sum()
        };
        let below = turn(&|i, j| self.below.steps(pairs[i].0, pairs[j].0));
        let above = turn(&|i, j| self.above.steps(pairs[i].1, pairs[j].1));
        let count = |side: &SliceEdges, edge| edge_count(side.line(edge)) as i64;
        below == count(self.below, pairs[0].0) && above.abs() == count(self.above, pairs[0].1)
    }

    /// The points of a chain on both sides, with the free edges at its ends.
    fn extended(&mut self, chain: &Chain) -> [Side; 2] {
        let sign = if chain.forward { 1 } else { -1 };
        let (first, last) = (chain.pairs[0], chain.pairs[chain.pairs.len() - 1]);
        let (below, above) = (self.below, self.above);
        if chain.round {
            let count = |side: &SliceEdges, edge| edge_count(side.line(edge)) as i64;
            return [
                side(below, first.0, 0, count(below, first.0), 1),
                side(above, first.1, 0, count(above, first.1), sign),
            ];
        }
        let total =
            |steps: &dyn Fn(usize) -> i64| -> i64 { (1..chain.pairs.len()).map(steps).sum() };
        let span = [
            total(&|i| below.steps(chain.pairs[i - 1].0, chain.pairs[i].0)),
            total(&|i| above.steps(chain.pairs[i - 1].1, chain.pairs[i].1).abs()),
        ];
        let mean: f64 = chain
            .pairs
            .iter()
            .map(|&(a, b)| self.distance(a, b))
            .sum::<f64>()
            / chain.pairs.len() as f64;
        for (a, b) in chain.pairs.windows(2).map(|w| (w[0], w[1])) {
            self.take_between(a, b, sign);
        }
        let before = self.free_edges(first, [-1, -sign], mean);
        let after = self.free_edges(last, [1, sign], mean);
        [
            side(
                below,
                first.0,
                -before[0],
                span[0] + 1 + before[0] + after[0],
                1,
            ),
            side(
                above,
                first.1,
                -before[1],
                span[1] + 1 + before[1] + after[1],
                sign,
            ),
        ]
    }

    /// Marks the free edges between two linked pairs.
    fn take_between(&mut self, p: (usize, usize), q: (usize, usize), sign: i64) {
        for k in 1..self.below.steps(p.0, q.0) {
            if let Some(a) = self.below.step(p.0, k) {
                self.taken_below[a] = true;
            }
        }
        for k in 1..self.above.steps(p.1, q.1).abs() {
            if let Some(b) = self.above.step(p.1, sign * k) {
                self.taken_above[b] = true;
            }
        }
    }

    /// How many free edges beyond `pair` join its strip, on either side.
    fn free_edges(&mut self, pair: (usize, usize), sign: [i64; 2], mean: f64) -> [i64; 2] {
        if let Some(free) = self.edges_to_border(pair, sign) {
            for k in 1..=free[0] {
                let edge = self.below.step(pair.0, sign[0] * k);
                edge.into_iter().for_each(|a| self.taken_below[a] = true);
            }
            for k in 1..=free[1] {
                let edge = self.above.step(pair.1, sign[1] * k);
                edge.into_iter().for_each(|b| self.taken_above[b] = true);
            }
            return free;
        }
        let mut free = [0; 2];
        for k in 1..=GAP as i64 {
            let Some(a) = self.below.step(pair.0, sign[0] * k) else {
                break;
            };
            let b = self.nearest_above[a];
            if self.taken_below[a] || !self.belongs(a, b, pair.1, true, mean) {
                break;
            }
            self.taken_below[a] = true;
            free[0] = k;
        }
        for k in 1..=GAP as i64 {
            let Some(b) = self.above.step(pair.1, sign[1] * k) else {
                break;
            };
            let a = self.nearest_below[b];
            if self.taken_above[b] || !self.belongs(a, b, pair.0, false, mean) {
                break;
            }
            self.taken_above[b] = true;
            free[1] = k;
        }
        free
    }

    /// The edges beyond `pair` on either side, where both lines leave the volume there, one of them
    /// soon, and no other strip has any of these edges.
    fn edges_to_border(&self, pair: (usize, usize), sign: [i64; 2]) -> Option<[i64; 2]> {
        let free = [
            self.below.edges_to_border(pair.0, sign[0])?,
            self.above.edges_to_border(pair.1, sign[1])?,
        ];
        let is_free = |side: &SliceEdges, taken: &[bool], edge, sign, count| {
            (1..=count).all(|k| side.step(edge, sign * k).is_some_and(|e| !taken[e]))
        };
        let joins = free[0].min(free[1]) <= GAP as i64
            && free[0].max(free[1]) <= LEAVING
            && is_free(self.below, &self.taken_below, pair.0, sign[0], free[0])
            && is_free(self.above, &self.taken_above, pair.1, sign[1], free[1]);
        joins.then_some(free)
    }

    /// Whether a free edge is near enough to the end `anchor` of a strip to join it.
    fn belongs(&self, a: usize, b: usize, anchor: usize, anchor_above: bool, mean: f64) -> bool {
        let near = if anchor_above {
            self.above.edges[b].line == self.above.edges[anchor].line
                && self.above.steps(b, anchor).unsigned_abs() as usize <= GAP
        } else {
            self.below.edges[a].line == self.below.edges[anchor].line
                && self.below.steps(a, anchor).unsigned_abs() as usize <= GAP
        };
        near && self.distance(a, b) <= FARTHER * mean
    }
}

/// How far apart two edges of one sheet can be: sheets of one component are farther apart than
/// they are thick, and an edge's own length is always within reach. Where slices are farther apart than
/// voxels within them, so much is added.
fn reach(side: &SliceEdges, edge: usize, thickness: f64) -> f64 {
    let line = side.line(edge);
    let at = i64::from(side.edges[edge].at);
    let [p, q] = [at, at + 1].map(|i| side.polylines.points[point(line, i) as usize]);
    let step = |axis: usize| length(side.polylines.voxel_steps.map(|row| row[axis]));
    let farther = step(2) - step(0).min(step(1));
    1.25 * thickness + 1.5 * length(sub(p, q)) + farther.max(0.0)
}

/// `count` edges from `offset` steps beyond `edge`, as points; `sign` −1 walks the line backward.
fn side(edges: &SliceEdges, edge: usize, offset: i64, count: i64, sign: i64) -> Side {
    let line = edges.line(edge);
    let at = i64::from(edges.edges[edge].at);
    // Walking backward, an edge is entered at its end.
    let first = if sign > 0 {
        at + offset
    } else {
        at + 1 - offset
    };
    (0..=count).map(|k| point(line, first + sign * k)).collect()
}
