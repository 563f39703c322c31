//! Sheets at the border of the volume, with one of their faces beyond it.

use phantoms::{Frame, Phantom, Shape, Slab, Thickness, Topology};

use crate::phantoms_known::{judged, judged_phantom};

const SIDE: usize = 64;
const RADIUS: f64 = 20.0;
const THICKNESS: f64 = 5.0;

#[test]
fn a_vesicle_whose_middle_turns_back_below_the_border_is_closed() {
    let middle = 0.5 * (SIDE as f64 - 1.0);
    for below in [0.7, 1.2, 1.7] {
        for axis in 0..3 {
            let mut centre = [middle + 0.3, middle - 0.2, middle + 0.1];
            centre[axis] = SIDE as f64 - 1.0 - RADIUS - below;
            let sphere = Slab {
                shape: Shape::Sphere {
                    centre,
                    radius: RADIUS,
                },
                thickness: Thickness::Constant(THICKNESS),
                label: 1,
            };
            let closed = Topology {
                components: 1,
                euler: 2,
                boundary_loops: 0,
            };
            let frame = Frame::new([SIDE; 3]);
            let phantom = Phantom::new("", frame, vec![sphere], Some(closed));
            let report = judged_phantom(&phantom);
            assert_eq!(
                report.connectivity.topology, closed,
                "{below} below: {report}"
            );
            assert!(report.max_error < 0.6, "{below} below: {report}");
        }
    }
}

#[test]
fn nothing_of_a_sheet_is_lost_in_corners_and_along_edges_of_the_volume() {
    // Nothing but the border cuts off a corner's piece of 13 square voxels here,
    let (.., report) = judged("gyroid", 3, false);
    assert_eq!(report.connectivity.topology.components, 2, "{report}");
    assert!(report.farthest < 1.1, "{report}");
    // and the contour tears beside an edge.
    let (.., report) = judged("gyroid", 6, false);
    assert!(report.farthest < 1.0, "{report}");
    assert_eq!(report.self_intersections, 0, "{report}");
}
