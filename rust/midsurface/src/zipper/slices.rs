//! Polylines that come from elsewhere: whether they lie in slices, and without repeated points.

use std::borrow::Cow;

use crate::error::{collected, push, Error, Result};
use crate::fields::eigen::{eigenvalues, eigenvector, Symmetric};
use crate::grid::{along, dot, length, sub, unit, Vec3};
use crate::zipper::polylines::{Polyline, Polylines};

/// How far a point may lie off its slice's plane, in mean edge lengths.
const OFF_PLANE: f64 = 1e-2;
/// Points of a line closer than this to the one before are one point, in mean edge lengths.
const COINCIDENT: f64 = 1e-4;

impl Polylines {
    /// Checks lines that come from elsewhere: indices, figures, and that the lines of each slice
    /// lie in a plane of their own, parallel to the others', in the order of the slice indices.
    ///
    /// # Errors
    /// [`Error::Polylines`], which says what is wrong.
    pub fn check(&self) -> Result<()> {
        let fail = |message: String| Err(Error::Polylines(message));
        if self.thickness.len() != self.points.len() {
            return fail("there is not one thickness a point".into());
        }
        if self.border_distance.len() != self.points.len() {
            return fail("there is not one distance from the border a point".into());
        }
        if let Some(i) = self
            .points
            .iter()
            .position(|p| !p.iter().all(|v| v.is_finite()))
        {
            return fail(format!(
                "point {i} has a coordinate that is no finite number"
            ));
        }
        if let Some(i) = self.thickness.iter().position(|t| !t.is_finite()) {
            return fail(format!("the thickness of point {i} is no finite number"));
        }
        let steps = self.voxel_steps.as_flattened();
        if !steps.iter().all(|v| v.is_finite()) {
            return fail(
                "a step from voxel to voxel has a coordinate that is no finite number".into(),
            );
        }
        let no_distance = |d: &f32| d.is_nan() || *d < 0.0;
        if let Some(i) = self.border_distance.iter().position(no_distance) {
            return fail(format!(
                "the distance of point {i} from the border is no distance"
            ));
        }
        let inside = |line: &Polyline| {
            line.first
                .checked_add(line.count)
                .is_some_and(|end| end <= self.points.len())
        };
        if let Some(i) = self.lines.iter().position(|line| !inside(line)) {
            return fail(format!("line {i} names points that are not there"));
        }
        let ranges = self.lines.iter().map(|l| (l.first, l.first + l.count));
        let mut ranges = collected(ranges)?;
        ranges.sort_unstable();
        if ranges
            .windows(2)
            .any(|w| w[1].0 < w[0].1 && w[1].0 < w[1].1)
        {
            return fail("two lines share points".into());
        }
        self.check_planes()
    }

    /// The lines ordered by slice, one group a slice.
    fn by_slice(&self) -> Result<Vec<Vec<usize>>> {
        let lines = (0..self.lines.len()).filter(|&i| self.lines[i].count > 0);
        let mut order = collected(lines)?;
        order.sort_unstable_by_key(|&i| (self.lines[i].slice, i));
        let same = |a: &usize, b: &usize| self.lines[*a].slice == self.lines[*b].slice;
        let mut groups = Vec::new();
        for group in order.chunk_by(same) {
            push(&mut groups, collected(group.iter().copied())?)?;
        }
        Ok(groups)
    }

    fn points_of(&self, line: usize) -> &[Vec3] {
        let line = &self.lines[line];
        &self.points[line.first..line.first + line.count]
    }

    fn check_planes(&self) -> Result<()> {
        let groups = self.by_slice()?;
        if groups.len() < 2 {
            return Ok(());
        }
        let tolerance = OFF_PLANE * self.mean_edge(0..self.lines.len());
        let centre = |group: &Vec<usize>| mean(group.iter().flat_map(|&l| self.points_of(l)));
        let centres = collected(groups.iter().map(centre))?;
        let normal = self.slice_normal(&groups, &centres);
        for (group, centre) in groups.iter().zip(&centres) {
            for &line in group {
                let off = |p: &Vec3| dot(sub(*p, *centre), normal).abs() > tolerance;
                if self.points_of(line).iter().any(off) {
                    return Err(Error::Polylines(format!(
                        "line {line} leaves the plane of its slice {}; the lines of a slice must \
                         lie in one plane, parallel to the other slices'",
                        self.lines[line].slice
                    )));
                }
            }
        }
        let heights = centres.iter().map(|c| dot(sub(*c, centres[0]), normal));
        let heights = collected(heights)?;
        let rising = heights.windows(2).all(|w| w[1] - w[0] > tolerance);
        let falling = heights.windows(2).all(|w| w[0] - w[1] > tolerance);
        if rising || falling {
            return Ok(());
        }
        Err(Error::Polylines(
            "two slices lie in one plane, or out of order".into(),
        ))
    }

    /// The direction across all slices: along which the points of a slice vary least.
    fn slice_normal(&self, groups: &[Vec<usize>], centres: &[Vec3]) -> Vec3 {
        let mut scatter: Symmetric<f64> = [0.0; 6];
        for (group, centre) in groups.iter().zip(centres) {
            for p in group.iter().flat_map(|&line| self.points_of(line)) {
                let [x, y, z] = sub(*p, *centre);
                for (sum, v) in scatter
                    .iter_mut()
                    .zip([x * x, y * y, z * z, x * y, x * z, y * z])
                {
                    *sum += v;
                }
            }
        }
        let [least, middle, largest] = eigenvalues(scatter);
        let between = sub(centres[centres.len() - 1], centres[0]);
        if middle - least > 1e-6 * largest {
            return eigenvector(scatter, least);
        }
        // All lines are straight and parallel: across them, from slice to slice.
        let straight = eigenvector(scatter, largest);
        unit(along(between, -dot(between, straight), straight))
    }

    /// Mean length of the edges of some of the lines.
    pub(crate) fn mean_edge(&self, lines: std::ops::Range<usize>) -> f64 {
        let (mut sum, mut count) = (0.0, 0usize);
        for line in lines {
            sum += self
                .points_of(line)
                .windows(2)
                .map(|w| length(sub(w[1], w[0])))
                .sum::<f64>();
            count += self.lines[line].count.saturating_sub(1);
        }
        sum / count.max(1) as f64
    }

    /// The lines without points that repeat the one before.
    pub(crate) fn without_repeats(&self) -> Result<Cow<'_, Self>> {
        let tolerance = COINCIDENT * self.mean_edge(0..self.lines.len());
        let near = |a: Vec3, b: Vec3| length(sub(a, b)) <= tolerance;
        let repeats = |line: usize| {
            let points = self.points_of(line);
            let closes = self.lines[line].closed && points.len() > 1;
            points.windows(2).any(|w| near(w[0], w[1]))
                || (closes && points.len() < 3)
                || (closes && near(points[0], points[points.len() - 1]))
        };
        if !(0..self.lines.len()).any(repeats) {
            return Ok(Cow::Borrowed(self));
        }
        let mut clean = Self {
            voxel_steps: self.voxel_steps,
            ..Self::default()
        };
        for (i, line) in self.lines.iter().enumerate() {
            let first = clean.points.len();
            for (k, &p) in self.points_of(i).iter().enumerate() {
                if clean.points.len() == first || !near(clean.points[clean.points.len() - 1], p) {
                    push(&mut clean.points, p)?;
                    push(&mut clean.thickness, self.thickness[line.first + k])?;
                    let distance = self.border_distance[line.first + k];
                    push(&mut clean.border_distance, distance)?;
                }
            }
            let repeats_first = |points: &[Vec3]| near(points[first], points[points.len() - 1]);
            while line.closed && clean.points.len() > first + 1 && repeats_first(&clean.points) {
                clean.points.pop();
                clean.thickness.pop();
                clean.border_distance.pop();
            }
            let count = clean.points.len() - first;
            let closed = line.closed && count >= 3;
            let line = Polyline {
                first,
                count,
                closed,
                ..line.clone()
            };
            push(&mut clean.lines, line)?;
        }
        Ok(Cow::Owned(clean))
    }
}

fn mean<'a>(points: impl Iterator<Item = &'a Vec3>) -> Vec3 {
    let add = |(sum, count), p: &Vec3| (along(sum, 1.0, *p), count + 1.0);
    let (sum, count) = points.fold(([0.0; 3], 0.0), add);
    sum.map(|v| v / count)
}
