//! Random numbers for phantoms: the same seed, the same phantom.

use crate::phantom::Frame;
use crate::vector::{add, cross, perpendicular, scale, unit, Vec3};

/// A seeded source of numbers, directions and places.
pub struct Dice(fastrand::Rng);

impl Dice {
    /// The same seed and the same name throw the same numbers.
    pub fn new(name: &str, seed: u64) -> Self {
        let mixed = name
            .bytes()
            .fold(seed ^ 0x9e37_79b9_7f4a_7c15, |mix, byte| {
                (mix ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
            });
        Self(fastrand::Rng::with_seed(mixed))
    }

    /// A number between two.
    pub fn between(&mut self, from: f64, to: f64) -> f64 {
        from + (to - from) * self.0.f64()
    }

    /// One of several.
    pub fn one_of<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[self.0.usize(..choices.len())]
    }

    /// A whole number for a seed.
    pub fn seed(&mut self) -> u64 {
        self.0.u64(..)
    }

    /// A unit vector; all directions are equally likely.
    pub fn direction(&mut self) -> Vec3 {
        let z = self.between(-1.0, 1.0);
        let (sin, cos) = self.between(0.0, std::f64::consts::TAU).sin_cos();
        let r = (1.0 - z * z).sqrt();
        [r * cos, r * sin, z]
    }

    /// Two unit vectors at right angles, in any orientation.
    pub fn axes(&mut self) -> [Vec3; 2] {
        let first = self.direction();
        let (sin, cos) = self.between(0.0, std::f64::consts::TAU).sin_cos();
        let across = perpendicular(first);
        let second = add(scale(cos, across), scale(sin, cross(first, across)));
        [first, unit(second)]
    }

    /// A rotation, row by row.
    pub fn rotation(&mut self) -> [Vec3; 3] {
        let [x, y] = self.axes();
        [x, y, cross(x, y)]
    }

    /// A point at most `spread` voxels from the middle of the volume along each axis.
    pub fn place(&mut self, frame: &Frame, spread: f64) -> Vec3 {
        let reach = spread * frame.unit();
        add(
            frame.middle(),
            [(); 3].map(|()| self.between(-reach, reach)),
        )
    }
}
