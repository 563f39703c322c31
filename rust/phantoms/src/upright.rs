//! Membranes that cross every slice along z: what the method that goes slice by slice must be exact
//! on, wherever they are and however they lean.

use crate::catalogue::tube;
use crate::dice::Dice;
use crate::phantom::{Frame, Phantom, Slab, Thickness, Topology};
use crate::shape::{Hole, Rim, Shape};
use crate::vector::{leaning, scale, sub, Vec3};

/// How thick they are, voxels.
const THICKNESS: f64 = 6.0;
/// How far the middle of one may be from that of the volume along each axis, voxels.
const SPREAD: f64 = 3.0;
/// The steepest lean, degrees.
const LEAN: f64 = 45.0;

/// A tube of radius 25 along z, through both faces of the volume, its axis anywhere.
pub fn upright_tube(seed: u64) -> Phantom {
    let mut dice = Dice::new("upright tube", seed);
    let side = dice.one_of(&[68, 80]);
    let frame = Frame::new([side, side, dice.one_of(&[12, 20, 48])]);
    let centre = dice.place(&frame, SPREAD);
    let mut phantom = tube(frame, 25.0, THICKNESS);
    let Slab { shape, .. } = &mut phantom.slabs[0];
    if let Shape::Tube { centre: own, .. } = shape {
        *own = centre;
    }
    let moved = sub(centre, phantom.frame.middle());
    let name = format!("tube {side} across, moved by {moved:.2?}");
    Phantom::new(&name, phantom.frame, phantom.slabs, phantom.topology)
}

/// A sheet that leans by up to 45 degrees from upright, to any side, with a round hole.
pub fn leaning_sheet(seed: u64) -> Phantom {
    let mut dice = Dice::new("leaning sheet", seed);
    let side = dice.one_of(&[56, 64, 80]);
    let frame = Frame::new([side; 3]);
    let (lean, azimuth) = (dice.between(0.0, LEAN), dice.between(0.0, 360.0));
    let centre = dice.place(&frame, SPREAD);
    let radius = dice.between(8.0, 14.0);
    let moved: Vec3 = sub(centre, scale(1.0, frame.middle()));
    let name = format!(
        "sheet in {side} voxels, {lean:.1} degrees, azimuth {azimuth:.1}, moved by {moved:.2?}, hole {radius:.1}"
    );
    let slab = Slab {
        shape: Shape::Plane {
            centre,
            normal: leaning(lean, azimuth),
            rim: Rim::None,
            holes: vec![Hole { centre, radius }],
        },
        thickness: Thickness::Constant(THICKNESS),
        label: 1,
    };
    let topology = Topology {
        components: 1,
        euler: 0,
        boundary_loops: 2,
    };
    Phantom::new(&name, frame, vec![slab], Some(topology))
}
