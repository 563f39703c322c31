//! A label volume that looks like a segmented mitochondrion in a tomogram: a curved organelle,
//! thicker than the slab of the tomogram, so that both membranes run through its z faces.
//!
//! Both membranes are shells round the zero level of a distance-like function, so that each is one
//! sheet without branches: the outer one round a bent capsule, the inner one round the matrix,
//! which is a smaller capsule minus the flat sacs (cristae) that push into it from both sides.

use crate::phantom::{flip_boundary, Frame};

/// Label of the outer membrane.
pub const OUTER: u8 = 1;
/// Label of the inner membrane.
pub const INNER: u8 = 2;

const THICKNESS: f64 = 4.0;
/// From mid-surface to mid-surface of the two membranes, voxels.
const MEMBRANES_APART: f64 = 10.0;
/// From mid-surface to mid-surface across a crista, and from one crista to the next, voxels.
const CRISTA_WIDTH: f64 = 9.0;
const CRISTAE_APART: f64 = 26.0;
/// Over how many voxels a crista's edges are rounded off.
const ROUNDING: f64 = 5.0;

/// Labels of a mitochondrion that fills a volume of these dimensions (each at least 32), x
/// fastest: [`OUTER`], [`INNER`], 0 elsewhere. This share of the voxels at the faces of the
/// membranes is flipped. The same seed, the same mitochondrion.
pub fn mitochondrion(dimensions: [usize; 3], noise: f64, seed: u64) -> Vec<u8> {
    let organelle = Organelle::new(dimensions, seed);
    let frame = Frame::new(dimensions);
    let [nx, ny, nz] = dimensions;
    let middle = frame.middle();
    let mut labels = Vec::with_capacity(nx * ny * nz);
    for z in 0..nz {
        for y in 0..ny {
            for x in 0..nx {
                let p = [x, y, z].map(|v| v as f64);
                labels.push(organelle.label(std::array::from_fn(|a| p[a] - middle[a])));
            }
        }
    }
    flip_boundary(&labels, dimensions, noise, seed)
}

/// A flat sac that pushes into the matrix.
struct Crista {
    /// Where it is along the organelle.
    position: f64,
    /// The side it comes from, −1 or 1, and how far over the middle it reaches.
    side: f64,
    reach: f64,
    /// How it leans: x gained per step along y and along z.
    lean: [f64; 2],
    phase: f64,
}

struct Organelle {
    radius: f64,
    half_length: f64,
    depth: f64,
    bend: f64,
    phase: f64,
    cristae: Vec<Crista>,
}

impl Organelle {
    fn new(dimensions: [usize; 3], seed: u64) -> Self {
        let [nx, ny, nz] = dimensions.map(|n| n as f64);
        let mut random = fastrand::Rng::with_seed(seed);
        let margin = 6.0;
        let bend = 0.08 * ny;
        let radius = 0.5 * ny - margin - bend;
        let half_length = (0.5 * nx - margin - radius).max(0.0);
        let last = (half_length + 0.25 * radius) / CRISTAE_APART;
        let cristae = (-last.floor() as i64..=last.floor() as i64)
            .map(|n| Crista {
                position: (n as f64 + 0.2 * (random.f64() - 0.5)) * CRISTAE_APART,
                side: if n % 2 == 0 { 1.0 } else { -1.0 },
                reach: (0.1 + 0.3 * random.f64()) * radius,
                lean: [0.2 * (random.f64() - 0.5), 0.3 * (random.f64() - 0.5)],
                phase: std::f64::consts::TAU * random.f64(),
            })
            .collect();
        Self {
            radius,
            half_length,
            depth: nz,
            bend,
            phase: std::f64::consts::TAU * random.f64(),
            cristae,
        }
    }

    fn label(&self, p: [f64; 3]) -> u8 {
        let capsule = self.capsule(p);
        if capsule.abs() <= 0.5 * THICKNESS {
            OUTER
        } else if capsule < 0.0 && self.matrix(p, capsule).abs() <= 0.5 * THICKNESS {
            INNER
        } else {
            0
        }
    }

    /// Distance from the outer membrane's mid-surface, negative inside. The radius shrinks
    /// towards the z faces, so that the membrane leans there.
    fn capsule(&self, p: [f64; 3]) -> f64 {
        let along = p[0] / (self.half_length + self.radius);
        let y = p[1] - self.bend * ((1.6 * along).cos() * 2.0 - 1.0);
        let waves = 1.5 * (0.09 * p[0] + self.phase).sin() * (0.07 * p[2] + self.phase).cos();
        let x = p[0] - p[0].clamp(-self.half_length, self.half_length);
        let height = 0.9 * self.radius * p[2] / self.depth;
        x.hypot(y).hypot(height) - self.radius - waves
    }

    /// Distance from the inner membrane's mid-surface, negative in the matrix.
    fn matrix(&self, p: [f64; 3], capsule: f64) -> f64 {
        let smaller = capsule + MEMBRANES_APART;
        self.cristae.iter().fold(smaller, |matrix, crista| {
            smooth_max(matrix, -crista.distance(p))
        })
    }
}

impl Crista {
    /// Distance from the wall of the sac, negative inside.
    fn distance(&self, p: [f64; 3]) -> f64 {
        let wave = 2.0 * (0.12 * p[1] + 0.08 * p[2] + self.phase).sin();
        let centre = self.position + self.lean[0] * p[1] + self.lean[1] * p[2] + wave;
        let across = (p[0] - centre).abs() - 0.5 * CRISTA_WIDTH;
        let beyond = -self.reach + 3.0 * (0.1 * p[2] + self.phase).cos() - self.side * p[1];
        smooth_max(across, beyond)
    }
}

/// The larger of two distances, rounded off where they are about the same.
fn smooth_max(a: f64, b: f64) -> f64 {
    let h = (ROUNDING - (a - b).abs()).max(0.0) / ROUNDING;
    a.max(b) + 0.25 * ROUNDING * h * h
}
