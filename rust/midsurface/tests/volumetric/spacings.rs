//! Slices farther apart than any microscope's: what a wrong header makes of a volume.

use phantoms::{Frame, Phantom, Shape, Slab, Thickness, Topology};

use crate::phantoms_known::judged_phantom;

#[test]
fn slices_very_far_apart_make_no_folds() {
    let open = Topology {
        components: 1,
        euler: 0,
        boundary_loops: 2,
    };
    for apart in [20.0, 32.0] {
        let tube = Slab {
            shape: Shape::Tube {
                centre: [31.7, 31.4, 0.0],
                axis: [0.0, 0.0, 1.0],
                radius: 22.0,
            },
            thickness: Thickness::Constant(5.0),
            label: 1,
        };
        let frame = Frame::with_spacing([64, 64, 16], [1.0, 1.0, apart]);
        let phantom = Phantom::new("", frame, vec![tube], Some(open));
        let report = judged_phantom(&phantom);
        assert_eq!(report.connectivity.topology, open, "{apart}: {report}");
        assert_eq!(report.self_intersections, 0, "{apart}: {report}");
        assert!(report.max_error < 0.6, "{apart}: {report}");
    }
}
