//! Membranes that bend: pits, folds, cristae, tubes round a corner.

use super::rows::{constant, cube, exactly, single};
use crate::dice::Dice;
use crate::phantom::{Phantom, Slab};
use crate::profile::Profile;
use crate::shape::Shape;
use crate::vector::{add, scale};

/// Farther than any border.
const FAR: f64 = 500.0;

/// A sheet with a pit: a tube with a round end that opens into the sheet with a rounded shoulder.
pub(super) fn invagination(dice: &mut Dice) -> Phantom {
    let frame = cube();
    let axis = dice.direction();
    let [tube, neck, shoulder] =
        [(7.0, 11.0), (4.0, 16.0), (5.0, 9.0)].map(|(from, to)| dice.between(from, to));
    let depth = tube + neck + shoulder;
    let profile = Profile::start([0.0, -depth], 0.0)
        .turn(tube, 90.0)
        .forward(neck)
        .turn(shoulder, -90.0)
        .forward(FAR);
    let shape = Shape::Revolved {
        centre: add(dice.place(&frame, 1.0), scale(0.4 * depth, axis)),
        axis,
        profile,
    };
    single(frame, shape, constant(dice, [2.0, 5.0]), [1, 1, 1])
}

/// A sheet that rises, turns round and comes back: two walls a few voxels apart.
pub(super) fn fold(dice: &mut Dice) -> Phantom {
    let frame = cube();
    let [across, up] = dice.axes();
    let [apex, wall, shoulder] =
        [(5.0, 8.0), (6.0, 16.0), (5.0, 9.0)].map(|(from, to)| dice.between(from, to));
    let profile = Profile::start([-FAR - apex - shoulder, 0.0], 0.0)
        .forward(FAR)
        .turn(shoulder, 90.0)
        .forward(wall)
        .turn(apex, -180.0)
        .forward(wall)
        .turn(shoulder, 90.0)
        .forward(FAR);
    let height = shoulder + wall + apex;
    let shape = Shape::Extruded {
        centre: add(dice.place(&frame, 1.0), scale(-0.5 * height, up)),
        across,
        up,
        profile,
    };
    single(frame, shape, constant(dice, [2.0, 4.0]), [1, 1, 1])
}

/// A closed inner membrane with a pit, inside a closed outer one.
pub(super) fn cristae(dice: &mut Dice) -> Phantom {
    let frame = cube();
    let axis = dice.direction();
    let centre = dice.place(&frame, 0.7);
    let (outer, gap) = (dice.between(38.0, 41.0), dice.between(5.0, 7.0));
    let inner = outer - gap;
    // From the bottom of the ball round to the shoulder, down into the pit and to its round end.
    let (pit, shoulder) = (dice.between(6.0, 9.0), 5.0);
    let polar = (pit + shoulder) / (inner - shoulder);
    let opening = polar.asin().to_degrees();
    let depth = dice.between(12.0, 20.0);
    let profile = Profile::start([0.0, -inner], 0.0)
        .turn(inner, 180.0 - opening)
        .turn(shoulder, 90.0 + opening)
        .forward(depth)
        .turn(pit, -90.0);
    let thickness = constant(dice, [2.0, 3.5]);
    let inner = Shape::Revolved {
        centre,
        axis,
        profile,
    };
    let outer = Shape::Sphere {
        centre,
        radius: outer,
    };
    let slabs = [inner, outer].map(|shape| Slab {
        shape,
        thickness,
        label: 1,
    });
    Phantom::new("", frame, slabs.to_vec(), exactly([2, 4, 0]))
}

/// A tube that turns a corner and leaves the volume at both ends.
pub(super) fn bent_tube(dice: &mut Dice) -> Phantom {
    let frame = cube();
    let [across, up] = dice.axes();
    let (bend, turn) = (dice.between(18.0, 30.0), dice.between(40.0, 110.0));
    let radius = dice.between(8.0, 13.0);
    let path = Profile::start([-FAR, 0.0], 0.0)
        .forward(FAR)
        .turn(bend, turn)
        .forward(FAR);
    // The middle of the bend near the middle of the volume.
    let half = 0.5 * turn.to_radians();
    let to_middle = add(
        scale(-bend * half.sin(), across),
        scale(-bend * (1.0 - half.cos()), up),
    );
    let shape = Shape::BentTube {
        centre: add(dice.place(&frame, 1.5), to_middle),
        across,
        up,
        path,
        radius,
    };
    single(frame, shape, constant(dice, [2.0, 5.0]), [1, 0, 2])
}
