//! A few points of a surface and those around them, to average over without touching all others.

use crate::error::{collected, filled, push, Result};
use crate::surface::halfedge::{Fans, NONE};

/// Points and so many rings of points around them.
pub(crate) struct Region<'a> {
    /// The points, those first that the others lie around.
    pub points: Vec<u32>,
    /// Where in that each point of the surface is, or [`NONE`].
    number: Vec<u32>,
    triangles: &'a [[u32; 3]],
    fans: &'a Fans,
}

impl<'a> Region<'a> {
    pub fn new(
        points: Vec<u32>,
        rings: usize,
        of_surface: usize,
        (triangles, fans): (&'a [[u32; 3]], &'a Fans),
    ) -> Result<Self> {
        let mut number = filled(NONE, of_surface)?;
        for (n, &p) in points.iter().enumerate() {
            number[p as usize] = n as u32;
        }
        let mut region = Self {
            points,
            number,
            triangles,
            fans,
        };
        let mut first = 0;
        for _ in 0..rings {
            for n in std::mem::replace(&mut first, region.points.len())..region.points.len() {
                region.add_around(region.points[n])?;
            }
        }
        Ok(region)
    }

    fn add_around(&mut self, p: u32) -> Result<()> {
        for &e in self.fans.of(p) {
            for q in self.triangles[e as usize / 3] {
                if self.number[q as usize] == NONE {
                    self.number[q as usize] = self.points.len() as u32;
                    push(&mut self.points, q)?;
                }
            }
        }
        Ok(())
    }

    /// Values at the points, averaged so many rounds over the corners of the triangles around.
    pub fn average<const N: usize>(
        &self,
        mut values: Vec<[f64; N]>,
        rounds: usize,
    ) -> Result<Vec<[f64; N]>> {
        let mut averaged = collected(values.iter().copied())?;
        for _ in 0..rounds {
            for (out, &p) in averaged.iter_mut().zip(&self.points) {
                let (mut sum, mut count) = ([0.0; N], 0.0);
                for &e in self.fans.of(p) {
                    for q in self.triangles[e as usize / 3] {
                        let n = self.number[q as usize];
                        if n != NONE {
                            for (sum, v) in sum.iter_mut().zip(values[n as usize]) {
                                *sum += v;
                            }
                            count += 1.0;
                        }
                    }
                }
                *out = sum.map(|v| v / f64::max(count, 1.0));
            }
            std::mem::swap(&mut averaged, &mut values);
        }
        Ok(values)
    }
}
