//! Label volumes made from known mid-surfaces.

use crate::shape::{Closest, Shape};
use crate::vector::{add, dot, length, scale, sub, Vec3};

/// Where the voxels lie: world = origin + direction · (spacing ∘ (extent_start + index)).
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    /// Number of voxels along x, y, z.
    pub dimensions: [usize; 3],
    /// Index of the first voxel in the image's extent.
    pub extent_start: [i64; 3],
    /// Distance between voxel centres, world units.
    pub spacing: Vec3,
    /// World coordinates of extent index (0, 0, 0).
    pub origin: Vec3,
    /// Row-major rotation whose columns are the image axes.
    pub direction: [Vec3; 3],
}

impl Frame {
    /// Cubic voxels of side 1, the first one at the origin.
    pub fn new(dimensions: [usize; 3]) -> Self {
        Self::with_spacing(dimensions, [1.0; 3])
    }

    /// The first voxel at the origin.
    pub fn with_spacing(dimensions: [usize; 3], spacing: Vec3) -> Self {
        Self {
            dimensions,
            extent_start: [0; 3],
            spacing,
            origin: [0.0; 3],
            direction: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        }
    }

    /// World coordinates of a continuous voxel index, counted from the first voxel.
    pub fn world(&self, index: Vec3) -> Vec3 {
        let place = |a: usize| self.spacing[a] * (self.extent_start[a] as f64 + index[a]);
        let local = [place(0), place(1), place(2)];
        let [x, y, z] = &self.direction;
        add(
            self.origin,
            [dot(*x, local), dot(*y, local), dot(*z, local)],
        )
    }

    /// Continuous voxel index of a world point; the inverse of [`Frame::world`].
    pub fn index(&self, world: Vec3) -> Vec3 {
        let d = sub(world, self.origin);
        let [x, y, z] = &self.direction;
        let index = |a: usize| {
            let local = x[a] * d[0] + y[a] * d[1] + z[a] * d[2];
            local / self.spacing[a] - self.extent_start[a] as f64
        };
        [index(0), index(1), index(2)]
    }

    /// The middle of the volume, world coordinates.
    pub fn middle(&self) -> Vec3 {
        self.world(self.dimensions.map(|n| (n as f64 - 1.0) / 2.0))
    }

    /// The finest spacing: the length that one "voxel" stands for.
    pub fn unit(&self) -> f64 {
        self.spacing.iter().copied().fold(f64::INFINITY, f64::min)
    }

    /// How far inside the outermost voxel centres a world point lies; negative outside.
    pub fn from_border(&self, world: Vec3) -> f64 {
        let index = self.index(world);
        (0..3)
            .map(|a| index[a].min(self.dimensions[a] as f64 - 1.0 - index[a]) * self.spacing[a])
            .fold(f64::INFINITY, f64::min)
    }

    /// Whether a world point lies between the outermost voxel centres.
    pub fn holds(&self, world: Vec3) -> bool {
        let index = self.index(world);
        (0..3).all(|a| index[a] > -1e-9 && index[a] < self.dimensions[a] as f64 - 1.0 + 1e-9)
    }
}

/// How far apart both faces are, measured along the normal, world units.
#[derive(Debug, Clone, Copy, PartialEq)]
#[allow(missing_docs)]
pub enum Thickness {
    /// Everywhere the same.
    Constant(f64),
    /// As thin as voxels can be without a hole, one layer of them: nothing gets through it by faces
    /// of voxels (26: the layer hangs together by corners), nor by corners (6: by faces).
    OneVoxel(Neighbours),
    /// `from` at the point `start`, `to` at `start + along`, linear in between, constant beyond.
    Linear {
        from: f64,
        to: f64,
        start: Vec3,
        along: Vec3,
    },
}

/// Which voxels hang together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum Neighbours {
    Six,
    TwentySix,
}

impl Thickness {
    /// The thickness at a point of a mid-surface whose unit normal there is given.
    pub fn at(&self, p: Vec3, normal: Vec3, frame: &Frame) -> f64 {
        match *self {
            Thickness::Constant(t) => t,
            Thickness::OneVoxel(neighbours) => {
                let step = |axis: usize| {
                    let along: f64 = (0..3).map(|r| frame.direction[r][axis] * normal[r]).sum();
                    along.abs() * frame.spacing[axis]
                };
                let steps = [0, 1, 2].map(step);
                match neighbours {
                    Neighbours::Six => steps.iter().sum(),
                    Neighbours::TwentySix => steps.into_iter().fold(0.0, f64::max),
                }
            }
            Thickness::Linear {
                from,
                to,
                start,
                along,
            } => {
                let t = (dot(sub(p, start), along) / dot(along, along)).clamp(0.0, 1.0);
                from + t * (to - from)
            }
        }
    }

    /// The greatest thickness anywhere.
    fn most(&self, frame: &Frame) -> f64 {
        match *self {
            Thickness::Constant(t) => t,
            Thickness::OneVoxel(_) => length(frame.spacing),
            Thickness::Linear { from, to, .. } => from.max(to),
        }
    }
}

/// One slab: a mid-surface, its thickness and the label of its voxels.
#[derive(Debug, Clone, PartialEq)]
#[allow(missing_docs)]
pub struct Slab {
    pub shape: Shape,
    pub thickness: Thickness,
    pub label: u8,
}

impl Slab {
    /// Whether a voxel centre that lies above or below the mid-surface is within the slab.
    fn holds(&self, p: Vec3, closest: &Closest, frame: &Frame) -> bool {
        match self.thickness {
            Thickness::OneVoxel(neighbours) => {
                closest.offset.abs() <= 0.5 * length(frame.spacing)
                    && self.is_nearer_than_a_neighbour_beyond(p, closest.offset, neighbours, frame)
            }
            _ => closest.offset.abs() <= 0.5 * self.thickness.at(p, closest.normal, frame),
        }
    }

    /// Whether the surface passes between this voxel and a neighbour, nearer to this one: then
    /// nothing gets from voxel to voxel through the surface beside the voxels chosen.
    fn is_nearer_than_a_neighbour_beyond(
        &self,
        p: Vec3,
        offset: f64,
        neighbours: Neighbours,
        frame: &Frame,
    ) -> bool {
        let index = frame.index(p);
        (0..27).any(|step| {
            let steps = [step % 3 - 1, step / 3 % 3 - 1, step / 9 - 1];
            let apart: i32 = steps.iter().map(|s: &i32| s.abs()).sum();
            if apart == 0 || (neighbours == Neighbours::TwentySix && apart > 1) {
                return false;
            }
            let beyond = frame.world(std::array::from_fn(|a| index[a] + f64::from(steps[a])));
            let other = self.shape.closest(beyond).offset;
            (offset > 0.0) != (other > 0.0) && offset.abs() <= other.abs()
        })
    }
}

/// What a mesh of the mid-surface must be like.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Topology {
    /// Number of connected components.
    pub components: usize,
    /// Vertices − edges + triangles.
    pub euler: i64,
    /// Number of closed rims.
    pub boundary_loops: usize,
}

impl std::fmt::Display for Topology {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(
            f,
            "{}/{}/{}",
            self.components, self.euler, self.boundary_loops
        )
    }
}

/// Where sheets meet along a line.
#[derive(Debug, Clone, PartialEq)]
pub struct Junction {
    /// A point of the line.
    pub point: Vec3,
    /// The line's direction.
    pub along: Vec3,
    /// The direction in which each sheet runs from the line, at right angles to it.
    pub sheets: Vec<Vec3>,
}

/// A label volume and the mid-surface it was made from.
#[derive(Debug, Clone, PartialEq)]
pub struct Phantom {
    /// What it is called.
    pub name: String,
    /// Where the voxels lie.
    pub frame: Frame,
    /// The labels, x fastest, then y, then z; 0 is background.
    pub labels: Vec<u8>,
    /// The slabs; where two overlap, the one whose mid-surface is nearer has the voxel.
    pub slabs: Vec<Slab>,
    /// Topology of the mid-surface within the volume; `None` where it is not a surface (branches)
    /// or not known (gyroids).
    pub topology: Option<Topology>,
    /// Where the slabs meet, if they do.
    pub junction: Option<Junction>,
}

impl Phantom {
    /// Labels every voxel whose centre is within half a thickness of a mid-surface, along the
    /// normal. Slabs end flat at a rim, so that the rim of the truth is the rim of the label.
    pub fn new(name: &str, frame: Frame, slabs: Vec<Slab>, topology: Option<Topology>) -> Self {
        let labels = label_voxels(&frame, &slabs);
        Self {
            name: name.to_owned(),
            frame,
            labels,
            slabs,
            topology,
            junction: None,
        }
    }

    /// Tells where the slabs meet.
    #[must_use]
    pub fn with_junction(mut self, junction: Junction) -> Self {
        self.junction = Some(junction);
        self
    }

    /// Flips this share of the voxels that touch a face of a label (6 neighbours): labelled ones
    /// become background, background ones take the label they touch. The same seed, the same noise.
    pub fn with_noise(mut self, share: f64, seed: u64) -> Self {
        self.labels = flip_boundary(&self.labels, self.frame.dimensions, share, seed);
        self
    }

    /// The closest point of the true mid-surface, and the slab it belongs to.
    ///
    /// # Panics
    /// Where the phantom has no slab.
    pub fn closest(&self, p: Vec3) -> (Closest, &Slab) {
        self.slabs
            .iter()
            .map(|slab| (slab.shape.closest(p), slab))
            .min_by(|a, b| a.0.distance.total_cmp(&b.0.distance))
            .expect("a phantom has a slab")
    }

    /// Points all over the true mid-surface within the outermost voxel centres, about one per
    /// `step`² (world units): the points of a cubic lattice next to the surface, moved onto it.
    pub fn truth_samples(&self, step: f64) -> Vec<Vec3> {
        let frame = &self.frame;
        let counts: [usize; 3] = std::array::from_fn(|a| {
            ((frame.dimensions[a] - 1) as f64 * frame.spacing[a] / step).floor() as usize + 1
        });
        let place = |n: [usize; 3]| {
            frame.world(std::array::from_fn(|a| {
                n[a] as f64 * step / frame.spacing[a]
            }))
        };
        let mut samples = Vec::new();
        for slab in &self.slabs {
            for block in blocks(counts) {
                let (middle, radius) = block.ball(place);
                if slab.shape.least_distance(middle) > radius + step {
                    continue;
                }
                for p in block.indices().map(place) {
                    if slab.shape.is_far(p, step) {
                        continue;
                    }
                    let closest = slab.shape.closest(p);
                    let near = closest.offset > -0.5 * step && closest.offset <= 0.5 * step;
                    if near && closest.distance <= step && frame.holds(closest.point) {
                        samples.push(closest.point);
                    }
                }
            }
        }
        samples
    }
}

/// A few neighbouring places of a grid.
struct Block {
    first: [usize; 3],
    end: [usize; 3],
}

impl Block {
    /// Middle and radius of a ball round all places of the block; `place` is affine.
    fn ball(&self, place: impl Fn([usize; 3]) -> Vec3) -> (Vec3, f64) {
        let (first, last) = (place(self.first), place(self.end.map(|n| n - 1)));
        let middle = scale(0.5, add(first, last));
        let corners = (0..8).map(|c| {
            place([0, 1, 2].map(|a| {
                if c >> a & 1 == 0 {
                    self.first[a]
                } else {
                    self.end[a] - 1
                }
            }))
        });
        let radius = corners.fold(0.0, |r: f64, corner| r.max(length(sub(corner, middle))));
        (middle, radius)
    }

    fn indices(&self) -> impl Iterator<Item = [usize; 3]> {
        let [x, y, z] = [0, 1, 2].map(|a| self.first[a]..self.end[a]);
        z.flat_map(move |k| {
            let x = x.clone();
            y.clone()
                .flat_map(move |j| x.clone().map(move |i| [i, j, k]))
        })
    }
}

/// Cuts a grid into blocks, so that what is far from every surface is seen at one look.
fn blocks(counts: [usize; 3]) -> impl Iterator<Item = Block> {
    const SIDE: usize = 6;
    let [nx, ny, nz] = counts.map(|n| n.div_ceil(SIDE));
    (0..nx * ny * nz).map(move |b| {
        let first = [b % nx, b / nx % ny, b / nx / ny].map(|n| n * SIDE);
        let end = std::array::from_fn(|a| (first[a] + SIDE).min(counts[a]));
        Block { first, end }
    })
}

fn label_voxels(frame: &Frame, slabs: &[Slab]) -> Vec<u8> {
    let [nx, ny, _] = frame.dimensions;
    let mut labels = vec![0; frame.dimensions.iter().product()];
    let place = |n: [usize; 3]| frame.world(n.map(|n| n as f64));
    for block in blocks(frame.dimensions) {
        let (middle, radius) = block.ball(place);
        let near: Vec<&Slab> = slabs
            .iter()
            .filter(|slab| {
                let reach = radius + 0.5 * slab.thickness.most(frame);
                slab.shape.least_distance(middle) <= reach
            })
            .collect();
        if near.is_empty() {
            continue;
        }
        for [x, y, z] in block.indices() {
            labels[x + nx * (y + ny * z)] = label_at(frame, &near, place([x, y, z]));
        }
    }
    labels
}

fn label_at(frame: &Frame, slabs: &[&Slab], p: Vec3) -> u8 {
    slabs
        .iter()
        .filter(|slab| !slab.shape.is_far(p, 0.5 * slab.thickness.most(frame)))
        .map(|slab| (slab.shape.closest(p), slab))
        .filter(|(closest, slab)| closest.within_rim && slab.holds(p, closest, frame))
        .min_by(|a, b| a.0.distance.total_cmp(&b.0.distance))
        .map_or(0, |(_, slab)| slab.label)
}

/// The labels with a share of the voxels at their faces flipped; see [`Phantom::with_noise`].
pub fn flip_boundary(labels: &[u8], dimensions: [usize; 3], share: f64, seed: u64) -> Vec<u8> {
    let [nx, ny, nz] = dimensions;
    let mut random = fastrand::Rng::with_seed(seed);
    let mut noisy = labels.to_vec();
    for z in 0..nz {
        for y in 0..ny {
            for x in 0..nx {
                let here = x + nx * (y + ny * z);
                let Some(other) = differing_neighbour(labels, dimensions, [x, y, z]) else {
                    continue;
                };
                if random.f64() < share {
                    noisy[here] = if labels[here] == 0 { other } else { 0 };
                }
            }
        }
    }
    noisy
}

/// The label of the first of the six neighbours that has another label than the voxel.
fn differing_neighbour(labels: &[u8], dimensions: [usize; 3], voxel: [usize; 3]) -> Option<u8> {
    let strides = [1, dimensions[0], dimensions[0] * dimensions[1]];
    let here: usize = (0..3).map(|a| voxel[a] * strides[a]).sum();
    (0..3)
        .flat_map(|a| {
            let before = (voxel[a] > 0).then(|| labels[here - strides[a]]);
            let after = (voxel[a] + 1 < dimensions[a]).then(|| labels[here + strides[a]]);
            [before, after]
        })
        .flatten()
        .find(|&label| label != labels[here])
}
