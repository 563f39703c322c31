//! The table of phantoms that a method is tried on, and what is asked of its meshes.
//!
//! Each [`Trial`] throws position, orientation, thickness and size from a seed. What is asked comes
//! in two grades: `must`, below which a mesh is wrong, and `aim`, what is worth working for.
//! Lengths are in voxels: the finest spacing; where the spacing is not cubic, limits on lengths
//! grow with the coarsest one.

mod bent;
mod frames;
mod limits;
mod rows;

pub use limits::{Grades, Limits};
pub use rows::trials;

use crate::dice::Dice;
use crate::judge::Report;
use crate::phantom::Phantom;

/// One line of the table.
#[derive(Clone)]
pub struct Trial {
    /// What it is called.
    pub name: &'static str,
    make: fn(&mut Dice) -> Phantom,
    /// Without noise.
    pub clean: Grades,
    /// With 5 % of the voxels at the label's faces flipped.
    pub noisy: Grades,
}

/// Share of the voxels at the label's faces that noise flips.
const NOISE: f64 = 0.05;

impl Trial {
    fn new(name: &'static str, make: fn(&mut Dice) -> Phantom) -> Self {
        Self {
            name,
            make,
            clean: Grades::usual(),
            noisy: Grades::usual_with_noise(),
        }
    }

    /// Changes what is asked, clean and noisy.
    fn but(mut self, change: impl Fn(&mut Grades)) -> Self {
        change(&mut self.clean);
        change(&mut self.noisy);
        self
    }

    /// Limits of the root mean square distance: clean and noisy, must and aim.
    fn rms(mut self, must: [f64; 2], aim: [f64; 2]) -> Self {
        (self.clean.must.rms, self.noisy.must.rms) = (must[0], must[1]);
        (self.clean.aim.rms, self.noisy.aim.rms) = (aim[0], aim[1]);
        self
    }

    /// With noise, the topology is no more than an aim.
    fn noisy_topology_is_an_aim(mut self) -> Self {
        self.noisy.must.topology = false;
        self
    }

    /// With noise, nothing is asked of the topology.
    fn noisy_topology_is_free(mut self) -> Self {
        self.noisy.must.topology = false;
        self.noisy.aim.topology = false;
        self
    }

    /// The phantom of a seed.
    pub fn phantom(&self, seed: u64, noisy: bool) -> Phantom {
        let mut dice = Dice::new(self.name, seed);
        let phantom = (self.make)(&mut dice);
        if noisy {
            let noise_seed = dice.seed();
            phantom.with_noise(NOISE, noise_seed)
        } else {
            phantom
        }
    }

    /// What is asked.
    pub fn grades(&self, noisy: bool) -> &Grades {
        if noisy {
            &self.noisy
        } else {
            &self.clean
        }
    }

    /// What falls short of `must`, and what only of `aim`, in words.
    pub fn verdict(
        &self,
        report: &Report,
        phantom: &Phantom,
        noisy: bool,
    ) -> (Vec<String>, Vec<String>) {
        let grades = self.grades(noisy);
        let missed = grades.must.missed(report, phantom);
        let columns: Vec<&str> = missed.iter().map(|(column, _)| *column).collect();
        let short = grades.aim.missed(report, phantom).into_iter();
        let only_aim = short.filter(|(column, _)| !columns.contains(column));
        let short = only_aim.map(|(_, text)| text).collect();
        (missed.into_iter().map(|(_, text)| text).collect(), short)
    }
}
