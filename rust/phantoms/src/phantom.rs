//! Label volumes made from known mid-surfaces.

use crate::shape::{Closest, Shape};
use crate::vector::{add, dot, sub, Vec3};

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
        let local: Vec3 =
            std::array::from_fn(|a| self.spacing[a] * (self.extent_start[a] as f64 + index[a]));
        add(self.origin, self.direction.map(|row| dot(row, local)))
    }

    /// Continuous voxel index of a world point; the inverse of [`Frame::world`].
    pub fn index(&self, world: Vec3) -> Vec3 {
        let d = sub(world, self.origin);
        std::array::from_fn(|a| {
            let local: f64 = (0..3).map(|r| self.direction[r][a] * d[r]).sum();
            local / self.spacing[a] - self.extent_start[a] as f64
        })
    }

    /// The middle of the volume, world coordinates.
    pub fn middle(&self) -> Vec3 {
        self.world(self.dimensions.map(|n| (n as f64 - 1.0) / 2.0))
    }

    /// The finest spacing: the length that one "voxel" stands for.
    pub fn unit(&self) -> f64 {
        self.spacing.iter().copied().fold(f64::INFINITY, f64::min)
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
    /// `from` at the point `start`, `to` at `start + along`, linear in between, constant beyond.
    Linear {
        from: f64,
        to: f64,
        start: Vec3,
        along: Vec3,
    },
}

impl Thickness {
    /// The thickness at a point.
    pub fn at(&self, p: Vec3) -> f64 {
        match *self {
            Thickness::Constant(t) => t,
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
}

/// One slab: a mid-surface, its thickness and the label of its voxels.
#[derive(Debug, Clone, PartialEq)]
#[allow(missing_docs)]
pub struct Slab {
    pub shape: Shape,
    pub thickness: Thickness,
    pub label: u8,
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
}

impl Phantom {
    /// Labels every voxel whose centre is within half a thickness of a mid-surface, along the
    /// normal. Slabs end flat at a rim, so that the rim of the truth is the rim of the label.
    pub fn new(name: &str, frame: Frame, slabs: Vec<Slab>, topology: Option<Topology>) -> Self {
        let [nx, ny, nz] = frame.dimensions;
        let mut labels = Vec::with_capacity(nx * ny * nz);
        for z in 0..nz {
            for y in 0..ny {
                for x in 0..nx {
                    let p = frame.world([x as f64, y as f64, z as f64]);
                    labels.push(label_at(&slabs, p));
                }
            }
        }
        Self {
            name: name.to_owned(),
            frame,
            labels,
            slabs,
            topology,
        }
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
        let mut samples = Vec::new();
        for slab in &self.slabs {
            for k in 0..counts[2] {
                for j in 0..counts[1] {
                    for i in 0..counts[0] {
                        let steps = [i, j, k].map(|n| n as f64 * step);
                        let index = std::array::from_fn(|a| steps[a] / frame.spacing[a]);
                        let closest = slab.shape.closest(frame.world(index));
                        let near = closest.offset > -0.5 * step && closest.offset <= 0.5 * step;
                        if near && closest.distance <= step && frame.holds(closest.point) {
                            samples.push(closest.point);
                        }
                    }
                }
            }
        }
        samples
    }
}

fn label_at(slabs: &[Slab], p: Vec3) -> u8 {
    slabs
        .iter()
        .map(|slab| (slab.shape.closest(p), slab))
        .filter(|(c, slab)| c.within_rim && c.offset.abs() <= 0.5 * slab.thickness.at(p))
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
