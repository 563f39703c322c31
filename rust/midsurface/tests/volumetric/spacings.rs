//! Slices far apart.

use phantoms::{Frame, Phantom, Rim, Shape, Slab, Thickness, Topology};

use crate::phantoms_known::judged_phantom;

/// The lattice of such a sheet's points is as regular as can be, and of poor triangles.
#[test]
fn a_flat_sheet_upright_in_slices_apart_is_flat() {
    let whole = Topology {
        components: 1,
        euler: 1,
        boundary_loops: 1,
    };
    for apart in [3.3, 3.5] {
        let sheet = Slab {
            shape: Shape::Plane {
                centre: [8.0, 20.0, 20.0],
                normal: [1.0, 0.0, 0.0],
                rim: Rim::None,
                holes: Vec::new(),
            },
            thickness: Thickness::Constant(3.0),
            label: 1,
        };
        let frame = Frame::with_spacing([24, 40, 40], [1.0, 1.0, apart]);
        let phantom = Phantom::new("", frame, vec![sheet], Some(whole));
        let report = judged_phantom(&phantom);
        assert_eq!(report.connectivity.topology, whole, "{apart}: {report}");
        assert!(report.max_error < 0.1, "{apart}: {report}");
        assert!(report.smallest_angle > 25.0, "{apart}: {report}");
    }
}

/// What a wrong header makes of a volume: farther apart than any microscope's.
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
