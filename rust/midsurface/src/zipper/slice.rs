//! One slice of one part: its pixels, what is already covered by lines, and the fields in it.

use crate::error::{collected, filled, push, zeros, Result};
use crate::fields::bricks::{Directory, EDGE, LAYER};
use crate::fields::interpolation::Sampler;
use crate::grid::{along, dot, floor, round, unit, Vec3};
use crate::reading::components::{touching, DisjointSets};
use crate::reading::runs::Run;
use crate::sheets::sheet::{normal, Sheet};

/// A pixel as column and row.
pub(crate) type Pixel = [usize; 2];
/// A point in a slice, work units.
pub(crate) type Point = [f64; 2];

/// A line runs through the pixel.
pub(crate) const LINE: u8 = 1;
/// The line that is being traced runs through the pixel.
pub(crate) const TRACED: u8 = 2;
/// The pixel belongs to a line, or no line was found for it.
pub(crate) const COVERED: u8 = 4;
/// Met while regions are collected.
const QUEUED: u8 = 8;

/// No component of the slice.
const NOWHERE: u32 = u32::MAX;

/// One slice of a part.
pub(crate) struct Slice<'a> {
    pub z: usize,
    pub fraction: Sampler<'a>,
    sheets: &'a [Sheet],
    /// First brick of the slice's brick layer.
    first_brick: usize,
    component: Vec<u32>,
    flags: Vec<u8>,
}

impl<'a> Slice<'a> {
    /// An empty slice over the bricks of the part at height `z`.
    pub fn new(fraction: Sampler<'a>, sheets: &'a [Sheet], z: usize) -> Result<Self> {
        let layer = fraction.directory.layer(z / EDGE);
        Ok(Self {
            z,
            fraction,
            sheets,
            first_brick: layer.start,
            component: filled(NOWHERE, layer.len() * LAYER)?,
            flags: zeros(layer.len() * LAYER)?,
        })
    }

    /// Work spacing.
    pub fn h(&self) -> Vec3 {
        self.fraction.h
    }

    pub fn directory(&self) -> &Directory {
        self.fraction.directory
    }

    #[inline]
    fn entry(&self, x: isize, y: isize) -> Option<usize> {
        if x < 0 || y < 0 {
            return None;
        }
        let (x, y) = (x as usize, y as usize);
        let brick = self
            .directory()
            .brick([x / EDGE, y / EDGE, self.z / EDGE])?;
        Some((brick - self.first_brick) * LAYER + y % EDGE * EDGE + x % EDGE)
    }

    /// The pixel a point lies in.
    pub fn pixel(&self, p: Point) -> [isize; 2] {
        let h = self.h();
        [round(p[0] / h[0]), round(p[1] / h[1])]
    }

    /// The middle of a pixel.
    pub fn centre(&self, pixel: Pixel) -> Point {
        let h = self.h();
        [pixel[0] as f64 * h[0], pixel[1] as f64 * h[1]]
    }

    /// Normal of the sheet and offset to its middle at a point, linear between the pixels that know
    /// it; `None` where those have less than a quarter of the weight.
    pub fn sheet(&self, p: Point) -> Option<(Vec3, f64)> {
        let (h, n) = (self.h(), self.directory().dimensions);
        let at: [f64; 2] = std::array::from_fn(|a| (p[a] / h[a]).clamp(0.0, (n[a] - 1) as f64));
        // None is negative, so that a cast is the floor.
        let low = at.map(|v| v as usize);
        let t = [at[0] - low[0] as f64, at[1] - low[1] as f64];
        let first = self.directory().entry([low[0], low[1], self.z]);
        let one_brick = low.iter().all(|v| v % EDGE + 1 < EDGE);
        let mut corners = [(0.0, Sheet::default()); 4];
        for (k, corner) in corners.iter_mut().enumerate() {
            let weight = [1.0 - t[0], t[0]][k % 2] * [1.0 - t[1], t[1]][k / 2];
            let entry = if one_brick {
                first.map(|first| first + k / 2 * EDGE + k % 2)
            } else {
                let voxel = [low[0] + k % 2, low[1] + k / 2, self.z];
                self.directory().entry(voxel)
            };
            if let (true, Some(entry)) = (weight > 0.0, entry) {
                *corner = (weight, self.sheets[entry]);
            }
        }
        let known = || {
            corners
                .iter()
                .filter_map(|(w, sheet)| Some((w, normal(sheet)?, sheet[3])))
        };
        let (_, first, _) = known().max_by(|a, b| a.0.total_cmp(b.0))?;
        let (mut mean, mut offset, mut total) = ([0.0; 3], 0.0, 0.0);
        for (weight, n, distance) in known() {
            // Normals have no sign of their own: all turned like the first.
            let signed = weight.copysign(dot(n, first));
            mean = along(mean, signed, n);
            offset += signed * f64::from(distance);
            total += weight;
        }
        (total >= 0.25).then(|| (unit(mean), offset / total))
    }

    /// Finds the slice's components (8 neighbours) and marks their pixels with their numbers.
    pub fn components(&mut self, runs: &[Run]) -> Result<Vec<Vec<Pixel>>> {
        let mut sets = DisjointSets::new(runs.len())?;
        let rows = runs.chunk_by(|a, b| a.y == b.y).scan(0, |end, row| {
            *end += row.len();
            Some(*end - row.len()..*end)
        });
        let rows = collected(rows)?;
        for pair in rows
            .windows(2)
            .filter(|w| runs[w[0].start].y + 1 == runs[w[1].start].y)
        {
            touching(runs, pair[1].clone(), pair[0].clone(), |a, b, _| {
                sets.join(a, b);
                Ok(())
            })?;
        }
        let mut number = filled(NOWHERE, runs.len())?;
        let mut components: Vec<Vec<Pixel>> = Vec::new();
        for (i, run) in runs.iter().enumerate() {
            let root = sets.find(i);
            if number[root] == NOWHERE {
                number[root] = components.len() as u32;
                push(&mut components, Vec::new())?;
            }
            let component = number[root];
            for x in run.start as usize..run.end as usize {
                let y = run.y as usize;
                push(&mut components[component as usize], [x, y])?;
                if let Some(entry) = self.entry(x as isize, y as isize) {
                    self.component[entry] = component;
                }
            }
        }
        Ok(components)
    }

    /// The component of a pixel.
    pub fn component(&self, [x, y]: [isize; 2]) -> Option<u32> {
        let component = self.component[self.entry(x, y)?];
        (component != NOWHERE).then_some(component)
    }

    /// Whether a pixel or one of its eight neighbours is of `component`.
    pub fn near(&self, [x, y]: [isize; 2], component: u32) -> bool {
        (-1..=1).any(|dy| (-1..=1).any(|dx| self.component([x + dx, y + dy]) == Some(component)))
    }

    /// Whether a point lies within the volume.
    pub fn inside(&self, p: Point) -> bool {
        let (h, n) = (self.h(), self.directory().dimensions);
        (0..2).all(|a| p[a] >= 0.0 && p[a] <= (n[a] - 1) as f64 * h[a])
    }

    /// Where the straight way from p, in the volume, to q, beyond it, meets the border.
    pub fn way_out(&self, p: Point, q: Point) -> Point {
        let (h, n) = (self.h(), self.directory().dimensions);
        let share = |a: usize| {
            let border = if q[a] < 0.0 {
                0.0
            } else {
                (n[a] - 1) as f64 * h[a]
            };
            let beyond = q[a] < 0.0 || q[a] > border;
            if beyond {
                (border - p[a]) / (q[a] - p[a])
            } else {
                1.0
            }
        };
        let t = share(0).min(share(1)).clamp(0.0, 1.0);
        self.clamp(std::array::from_fn(|a| p[a] + t * (q[a] - p[a])))
    }

    /// Whether a point lies on a border of the volume across x, and across y.
    pub fn on_border(&self, p: Point) -> [bool; 2] {
        let (h, n) = (self.h(), self.directory().dimensions);
        std::array::from_fn(|a| p[a].min((n[a] - 1) as f64 * h[a] - p[a]) < 1e-2 * h[a])
    }

    /// A point that lies beyond the border by no more than rounding does, put back.
    pub fn back_inside(&self, p: Point) -> Point {
        let inside = self.clamp(p);
        let h = self.h();
        let is_rounding = (0..2).all(|a| (p[a] - inside[a]).abs() < 1e-4 * h[a]);
        if is_rounding {
            inside
        } else {
            p
        }
    }

    /// The nearest point within the volume.
    pub fn clamp(&self, p: Point) -> Point {
        let (h, n) = (self.h(), self.directory().dimensions);
        std::array::from_fn(|a| p[a].clamp(0.0, (n[a] - 1) as f64 * h[a]))
    }

    /// Whether `flag` is set on a pixel.
    pub fn has(&self, [x, y]: [isize; 2], flag: u8) -> bool {
        self.entry(x, y)
            .is_some_and(|entry| self.flags[entry] & flag != 0)
    }

    /// Sets `flag` on a pixel.
    pub fn set(&mut self, [x, y]: [isize; 2], flag: u8) {
        if let Some(entry) = self.entry(x, y) {
            self.flags[entry] |= flag;
        }
    }

    /// Takes `flag` off a pixel.
    pub fn clear(&mut self, [x, y]: [isize; 2], flag: u8) {
        if let Some(entry) = self.entry(x, y) {
            self.flags[entry] &= !flag;
        }
    }

    /// Covers the pixels of `component` within `radius` of a point.
    pub fn cover(&mut self, p: Point, radius: f64, component: u32) {
        let h = self.h();
        let range = |a: usize| {
            let from = -floor((radius - p[a]) / h[a]);
            let to = floor((p[a] + radius) / h[a]);
            (from.max(0) as usize, to)
        };
        let ((left, right), (top, bottom)) = (range(0), range(1));
        if right < 0 || bottom < 0 {
            return;
        }
        let (right, bottom) = (right as usize, bottom as usize);
        for by in top / EDGE..=bottom / EDGE {
            for bx in left / EDGE..=right / EDGE {
                let Some(brick) = self.directory().brick([bx, by, self.z / EDGE]) else {
                    continue;
                };
                let first = (brick - self.first_brick) * LAYER;
                let (x, y) = (bx * EDGE, by * EDGE);
                let (x, end) = (x.max(left), (x + EDGE - 1).min(right) + 1);
                for y in y.max(top)..=(y + EDGE - 1).min(bottom) {
                    let row = first + y % EDGE * EDGE + x % EDGE;
                    let row = row..row + (end - x);
                    let dy = y as f64 * h[1] - p[1];
                    let pixels = self.flags[row.clone()].iter_mut().zip(&self.component[row]);
                    for (x, (flags, &own)) in (x as u32..).zip(pixels) {
                        let dx = f64::from(x) * h[0] - p[0];
                        let within = dx * dx + dy * dy <= radius * radius;
                        *flags |= COVERED * u8::from(within & (own == component));
                    }
                }
            }
        }
    }

    /// The connected regions (8 neighbours) of the pixels that are not covered.
    pub fn uncovered(&mut self, pixels: &[Pixel]) -> Result<Vec<Vec<Pixel>>> {
        let mut regions = Vec::new();
        let open = |slice: &Self, [x, y]: [isize; 2], component| {
            let entry = slice.entry(x, y)?;
            let is_open =
                slice.component[entry] == component && slice.flags[entry] & (COVERED | QUEUED) == 0;
            is_open.then_some(entry)
        };
        for &seed in pixels {
            let at = seed.map(|v| v as isize);
            let Some(entry) = self.entry(at[0], at[1]) else {
                continue;
            };
            let component = self.component[entry];
            if component == NOWHERE || self.flags[entry] & (COVERED | QUEUED) != 0 {
                continue;
            }
            self.flags[entry] |= QUEUED;
            let mut region = vec![seed];
            let mut next = 0;
            while next < region.len() {
                let [x, y] = region[next].map(|v| v as isize);
                next += 1;
                for (dx, dy) in (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (dx, dy))) {
                    let p = [x + dx, y + dy];
                    if let Some(entry) = open(self, p, component) {
                        self.flags[entry] |= QUEUED;
                        push(&mut region, p.map(|v| v as usize))?;
                    }
                }
            }
            push(&mut regions, region)?;
        }
        for &pixel in regions.iter().flatten() {
            self.clear(pixel.map(|v| v as isize), QUEUED);
        }
        Ok(regions)
    }
}
