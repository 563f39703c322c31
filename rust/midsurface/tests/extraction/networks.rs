//! Labels that branch in every slice: the work comes to an end, and the mesh is sound.

use midsurface::Grid;
use phantoms::*;

use crate::measure::{extract_all, report_of};

/// A spine across the volume with teeth on one side, `pitch` apart, all upright.
fn comb(dimensions: [usize; 3], pitch: f64, azimuth: f64, thickness: f64) -> Phantom {
    let frame = Frame::new(dimensions);
    let (across, along) = (leaning(0.0, azimuth), leaning(0.0, azimuth + 90.0));
    let middle = frame.middle();
    let plane = |offset: f64, normal, rim| Slab {
        shape: Shape::Plane {
            centre: std::array::from_fn(|a| middle[a] + offset * along[a]),
            normal,
            rim,
            holes: Vec::new(),
        },
        thickness: Thickness::Constant(thickness),
        label: 1,
    };
    let teeth = (-8..=8).map(|i| plane(f64::from(i) * pitch, along, Rim::Line(across)));
    let slabs = std::iter::once(plane(0.0, across, Rim::None)).chain(teeth);
    Phantom::new("comb", frame, slabs.collect(), None)
}

/// Upright walls between hexagonal cells whose centres are `pitch` apart.
fn honeycomb([nx, ny, nz]: [usize; 3], pitch: f64, thickness: f64) -> Vec<u8> {
    let row = 0.75f64.sqrt() * pitch;
    let is_wall = |x: f64, y: f64| {
        let mut nearest = [f64::INFINITY; 2];
        for j in -1..(ny as f64 / row) as i32 + 3 {
            for i in -1..(nx as f64 / pitch) as i32 + 3 {
                let shift = 0.5 * f64::from(j.rem_euclid(2));
                let (dx, dy) = (x - (f64::from(i) + shift) * pitch, y - f64::from(j) * row);
                let d = dx.hypot(dy);
                nearest = if d < nearest[0] {
                    [d, nearest[0]]
                } else {
                    [nearest[0], nearest[1].min(d)]
                };
            }
        }
        // Away from the corners, half the difference is the distance to the wall.
        nearest[1] - nearest[0] <= thickness
    };
    let slice: Vec<u8> = (0..nx * ny)
        .map(|i| u8::from(is_wall((i % nx) as f64, (i / nx) as f64)))
        .collect();
    slice.repeat(nz)
}

#[test]
fn combs_keep_their_teeth() {
    for (pitch, azimuth) in [(9.0, 0.0), (9.0, 30.0), (12.0, 17.0)] {
        let report = report_of(&comb([72, 72, 16], pitch, azimuth, 3.0));
        // A tooth's line ends some voxels before the spine, and bends the spine a little.
        assert!(
            report.covered_within_1 >= 0.95 && report.rms <= 0.5,
            "{pitch} apart, azimuth {azimuth}: {report}"
        );
    }
}

#[test]
fn honeycombs_keep_their_walls() {
    for (pitch, thickness) in [(16.0, 3.0), (24.0, 5.0)] {
        let dimensions = [96, 96, 12];
        let labels = honeycomb(dimensions, pitch, thickness);
        let (mesh, _) = extract_all(&labels, Grid::new(dimensions));
        // Walls of such a lattice have a length of 2 / pitch in each unit of area.
        let expected = 2.0 / pitch * 95.0 * 95.0 * 11.0;
        let share = mesh.quality().unwrap().area / expected;
        assert!((0.85..=1.1).contains(&share), "{share} of the walls' area");
    }
}
