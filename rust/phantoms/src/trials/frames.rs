//! Slices that lie farther apart than the voxels within them.

use super::rows::{single, SIDE};
use super::Trial;
use crate::dice::Dice;
use crate::phantom::{Frame, Phantom, Thickness};
use crate::shape::{Hole, Rim, Shape};
use crate::vector::{scale, sub, unit, Vec3};

pub(super) fn frame_trials() -> Vec<Trial> {
    vec![
        Trial::new("sphere, slices apart", |d| {
            let frame = stretched(d);
            let [radius, thick] = [(24.0, 36.0), (2.5, 3.5)].map(|(a, b)| d.between(a, b));
            let thick = thick * coarsest(&frame);
            in_units(frame, d, |centre, unit| {
                let radius = radius * unit;
                (Shape::Sphere { centre, radius }, thick, [1, 2, 0])
            })
        }),
        Trial::new("tube, slices apart", |d| {
            let frame = stretched(d);
            let (axis, radius) = (d.direction(), d.between(16.0, 24.0));
            let thick = d.between(2.5, 3.5) * coarsest(&frame);
            in_units(frame, d, |centre, unit| {
                let radius = radius * unit;
                (
                    Shape::Tube {
                        centre,
                        axis,
                        radius,
                    },
                    thick,
                    [1, 0, 2],
                )
            })
        }),
        Trial::new("disk with a hole, slices apart", |d| {
            let frame = stretched(d);
            let normal = d.direction();
            let thick = d.between(2.5, 3.5) * coarsest(&frame);
            in_units(frame, d, |centre, unit| {
                let shape = Shape::Plane {
                    centre,
                    normal,
                    rim: Rim::Circle(34.0 * unit),
                    holes: vec![Hole {
                        centre,
                        radius: 14.0 * unit,
                    }],
                };
                (shape, thick, [1, 0, 2])
            })
        }),
        Trial::new("disk lying in slices apart", lying_in_slices),
    ]
}

/// A disk with a hole that fills a few slices exactly, so that its middle is known.
fn lying_in_slices(dice: &mut Dice) -> Phantom {
    let frame = stretched(dice);
    let layers = dice.one_of(&[2.0, 3.0, 4.0, 5.0]);
    let middle = frame.dimensions.map(|n| (n as f64 / 2.0).floor());
    let [x, y] = [(); 2].map(|()| dice.between(-0.7, 0.7));
    let z = middle[2] + 0.5 * (layers - 1.0);
    let centre = frame.world([middle[0] + x, middle[1] + y, z]);
    let along_z = sub(frame.world([0.0, 0.0, 1.0]), frame.world([0.0; 3]));
    let radius = frame.unit() * dice.between(12.0, 16.0);
    let shape = Shape::Plane {
        centre,
        normal: unit(along_z),
        rim: Rim::Circle(34.0 * frame.unit()),
        holes: vec![Hole { centre, radius }],
    };
    // A little less than what reaches the next slices.
    let thickness = Thickness::Constant((layers - 0.1) * frame.spacing[2]);
    single(frame, shape, thickness, [1, 0, 2])
}

/// Slices up to 4 times as far apart as the voxels within them, lying and placed anyhow.
fn stretched(dice: &mut Dice) -> Frame {
    let unit = dice.one_of(&[0.5, 1.0, 12.44]);
    let apart = dice.between(1.2, 4.0);
    let slices = (SIDE as f64 / apart).round() as usize;
    let mut frame = Frame::with_spacing([SIDE, SIDE, slices], [unit, unit, unit * apart]);
    frame.direction = dice.rotation();
    frame.origin = scale(100.0 * unit, dice.direction());
    frame.extent_start = [dice.one_of(&[0, -7, 13]), 5, dice.one_of(&[0, 31])];
    frame
}

/// The coarsest spacing, in voxels.
fn coarsest(frame: &Frame) -> f64 {
    frame.spacing.into_iter().fold(0.0, f64::max) / frame.unit()
}

/// A single slab whose shape is made from its centre and the length of a voxel; the thickness in
/// voxels.
fn in_units(
    frame: Frame,
    dice: &mut Dice,
    make: impl Fn(Vec3, f64) -> (Shape, f64, [i64; 3]),
) -> Phantom {
    let unit = frame.unit();
    let centre = dice.place(&frame, 0.7);
    let (shape, thickness, topology) = make(centre, unit);
    single(
        frame,
        shape,
        Thickness::Constant(thickness * unit),
        topology,
    )
}
