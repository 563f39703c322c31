//! How a mesh lies within the label it came from, where the truth is not known.

use rstar::RTree;

use crate::phantom::Frame;
use crate::triangle_shape::area;
use crate::vector::{add, cross, length, scale, sub, unit, Vec3};

/// What was found. Lengths in voxels: the finest spacing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MaskFit {
    /// Mean of half the difference between the distances to both faces of the label, along the
    /// triangle's normal, over the part of the mesh inside the label.
    pub off_centre_mean: f64,
    /// What 95 % of those half differences stay under.
    pub off_centre_95: f64,
    /// Share, 0 to 1, of the mesh's area that lies inside the label.
    pub inside: f64,
    /// Share, 0 to 1, of the mesh's area outside the label grown by one voxel.
    pub excess: f64,
    /// Share, 0 to 1, of the label's voxels that lie as near to the mesh as the label is deep
    /// within 4 voxels of them, and one voxel more.
    pub covered: f64,
}

/// The label's faces are looked for in steps of this many voxels.
const STEP: f64 = 0.1;

/// And given up after so many.
const STEPS: usize = 400;

/// Half the side of the cube in which the greatest depth of the label counts, voxels.
const WINDOW: i64 = 4;

/// Holds a mesh in world coordinates against the voxels that are labelled. What lies outside the
/// volume counts as outside the label.
///
/// # Panics
/// Where a triangle names a point that does not exist, or `labelled` has not one entry a voxel.
pub fn mask_fit(
    points: &[[f32; 3]],
    triangles: &[[u32; 3]],
    labelled: &[bool],
    frame: &Frame,
) -> MaskFit {
    assert_eq!(labelled.len(), frame.dimensions.iter().product::<usize>());
    let mask = Mask { labelled, frame };
    let samples = samples(points, triangles, frame.unit());
    let mut off_centre = Vec::new();
    let (mut inside, mut excess) = (0, 0);
    for &(p, normal) in &samples {
        excess += usize::from(!mask.grown_holds(p));
        if mask.holds(p) {
            inside += 1;
            let [ahead, behind] = [1.0, -1.0].map(|way| mask.reach(p, scale(way, normal)));
            off_centre.push(0.5 * (ahead - behind).abs());
        }
    }
    off_centre.sort_by(f64::total_cmp);
    let count = samples.len() as f64;
    let at_95 = off_centre.get((0.95 * off_centre.len() as f64) as usize);
    MaskFit {
        off_centre_mean: off_centre.iter().sum::<f64>() / off_centre.len() as f64,
        off_centre_95: at_95.copied().unwrap_or(f64::NAN),
        inside: inside as f64 / count,
        excess: excess as f64 / count,
        covered: covered(&mask, samples.into_iter().map(|(p, _)| p).collect()),
    }
}

/// Points all over the mesh, two a square voxel, with the normal of their triangle; anywhere in it,
/// always the same. Small triangles take turns, so that the points are even.
fn samples(points: &[[f32; 3]], triangles: &[[u32; 3]], unit_length: f64) -> Vec<(Vec3, Vec3)> {
    let mut samples = Vec::new();
    let (mut due, mut thrown) = (0.0, 0usize);
    let mut random = fastrand::Rng::with_seed(0);
    for triangle in triangles {
        let t = triangle.map(|v| points[v as usize].map(f64::from));
        due += 2.0 * area(&t) / (unit_length * unit_length);
        let count = (due - thrown as f64) as usize;
        thrown += count;
        let normal = unit(cross(sub(t[1], t[0]), sub(t[2], t[0])));
        samples.extend((0..count).map(|_| {
            let (mut u, mut v) = (random.f64(), random.f64());
            if u + v > 1.0 {
                (u, v) = (1.0 - u, 1.0 - v);
            }
            let across = add(scale(u, sub(t[1], t[0])), scale(v, sub(t[2], t[0])));
            (add(t[0], across), normal)
        }));
    }
    samples
}

struct Mask<'a> {
    labelled: &'a [bool],
    frame: &'a Frame,
}

impl Mask<'_> {
    /// Whether a voxel is labelled; nothing outside the volume is.
    fn at(&self, voxel: [i64; 3]) -> bool {
        let [nx, ny, nz] = self.frame.dimensions.map(|n| n as i64);
        let [x, y, z] = voxel;
        (0..nx).contains(&x)
            && (0..ny).contains(&y)
            && (0..nz).contains(&z)
            && self.labelled[(x + nx * (y + ny * z)) as usize]
    }

    /// Whether the labels, interpolated linearly between voxel centres, reach one half.
    fn holds(&self, world: Vec3) -> bool {
        let index = self.frame.index(world);
        let last = self.frame.dimensions.map(|n| n as f64 - 1.0);
        // Rounding must not put what lies on the border outside.
        if (0..3).any(|a| index[a] < -1e-6 || index[a] > last[a] + 1e-6) {
            return false;
        }
        let index: Vec3 = std::array::from_fn(|a| index[a].clamp(0.0, last[a]));
        let first = index.map(|v| v.floor() as i64);
        let sum: f64 = (0..8)
            .map(|corner| {
                let bits = [corner & 1, corner >> 1 & 1, corner >> 2];
                let voxel = std::array::from_fn(|a| first[a] + bits[a]);
                let weight = |a: usize| {
                    let t = index[a] - first[a] as f64;
                    if bits[a] == 1 {
                        t
                    } else {
                        1.0 - t
                    }
                };
                if self.at(voxel) {
                    weight(0) * weight(1) * weight(2)
                } else {
                    0.0
                }
            })
            .sum();
        sum >= 0.5
    }

    /// Whether the nearest voxel or one that shares a face with it is labelled.
    fn grown_holds(&self, world: Vec3) -> bool {
        let voxel = self.frame.index(world).map(|v| v.round() as i64);
        self.at(voxel) || beside(voxel).any(|other| self.at(other))
    }

    /// All labelled voxels, x fastest.
    fn voxels(&self) -> Vec<[i64; 3]> {
        let [nx, ny, _] = self.frame.dimensions;
        let labelled = self.labelled.iter().enumerate().filter(|(_, l)| **l);
        labelled
            .map(|(i, _)| [i % nx, i / nx % ny, i / nx / ny].map(|v| v as i64))
            .collect()
    }

    /// How far it is from a point along a direction to the label's face, voxels.
    fn reach(&self, from: Vec3, direction: Vec3) -> f64 {
        let step = STEP * self.frame.unit();
        let steps = (1..STEPS).take_while(|&i| {
            let p = add(from, scale(i as f64 * step, direction));
            self.holds(p)
        });
        steps.count() as f64 * STEP
    }
}

/// At most so many labelled voxels are looked at, evenly spread over the volume.
const VOXELS: usize = 200_000;

fn covered(mask: &Mask, samples: Vec<Vec3>) -> f64 {
    let voxels = mask.voxels();
    let depths = Depths::new(mask, &voxels);
    let tree = RTree::bulk_load(samples);
    let looked_at = voxels.iter().step_by(voxels.len().div_ceil(VOXELS).max(1));
    let count = looked_at.len() as f64;
    let covered = looked_at.filter(|voxel| {
        let p = mask.frame.world(voxel.map(|v| v as f64));
        let nearest = tree.nearest_neighbor(&p);
        let distance = nearest.map_or(f64::INFINITY, |&q| length(sub(p, q)));
        distance <= depths.greatest_near(**voxel) + mask.frame.unit()
    });
    covered.count() as f64 / count
}

/// How far labelled voxels are from the nearest one that is not labelled.
struct Depths {
    order: Order,
    /// World units, one entry a labelled voxel.
    values: Vec<f64>,
}

impl Depths {
    /// The nearest voxel outside a label shares a face with a voxel of the label.
    fn new(mask: &Mask, voxels: &[[i64; 3]]) -> Self {
        let place = |voxel: [i64; 3]| mask.frame.world(voxel.map(|v| v as f64));
        let mut outside: Vec<[i64; 3]> = Vec::new();
        for voxel in voxels {
            outside.extend(beside(*voxel).filter(|&other| !mask.at(other)));
        }
        outside.sort_unstable();
        outside.dedup();
        let tree = RTree::bulk_load(outside.into_iter().map(place).collect());
        let depth = |&voxel: &[i64; 3]| {
            let p = place(voxel);
            let nearest = tree.nearest_neighbor(&p);
            nearest.map_or(f64::INFINITY, |&q| length(sub(p, q)))
        };
        Self {
            order: Order::new(mask),
            values: voxels.iter().map(depth).collect(),
        }
    }

    /// The greatest depth in the window round a voxel.
    fn greatest_near(&self, [x, y, z]: [i64; 3]) -> f64 {
        let mut greatest: f64 = 0.0;
        for k in z - WINDOW..=z + WINDOW {
            for j in y - WINDOW..=y + WINDOW {
                for i in x - WINDOW..=x + WINDOW {
                    if let Some(place) = self.order.of([i, j, k]) {
                        greatest = greatest.max(self.values[place]);
                    }
                }
            }
        }
        greatest
    }
}

/// The place of a labelled voxel among all labelled ones, from a bit a voxel and the number of
/// bits set before each word of them.
struct Order {
    words: Vec<(u64, u32)>,
    dimensions: [i64; 3],
}

impl Order {
    fn new(mask: &Mask) -> Self {
        let mut before = 0;
        let words = mask.labelled.chunks(64).map(|chunk| {
            let bits = chunk
                .iter()
                .rev()
                .fold(0u64, |bits, &l| bits << 1 | u64::from(l));
            before += bits.count_ones();
            (bits, before - bits.count_ones())
        });
        Self {
            words: words.collect(),
            dimensions: mask.frame.dimensions.map(|n| n as i64),
        }
    }

    fn of(&self, voxel: [i64; 3]) -> Option<usize> {
        if (0..3).any(|a| voxel[a] < 0 || voxel[a] >= self.dimensions[a]) {
            return None;
        }
        let [nx, ny, _] = self.dimensions;
        let index = (voxel[0] + nx * (voxel[1] + ny * voxel[2])) as usize;
        let (bits, before) = self.words[index / 64];
        let bit = 1u64 << (index % 64);
        (bits & bit != 0).then(|| before as usize + (bits & (bit - 1)).count_ones() as usize)
    }
}

/// The six voxels that share a face with one.
fn beside(voxel: [i64; 3]) -> impl Iterator<Item = [i64; 3]> {
    (0..6).map(move |side| {
        let mut other = voxel;
        other[side / 2] += if side % 2 == 0 { -1 } else { 1 };
        other
    })
}
