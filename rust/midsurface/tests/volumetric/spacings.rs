//! Slices far apart.

use phantoms::{Frame, Phantom, Report, Rim, Shape, Slab, Thickness, Topology};

use crate::phantoms_known::judged_phantom;

/// What is to be said of a sheet in slices so far apart; its topology is asserted.
fn judged(
    dimensions: [usize; 3],
    apart: f64,
    (shape, thickness): (Shape, f64),
    topology: Topology,
) -> Report {
    let slab = Slab {
        shape,
        thickness: Thickness::Constant(thickness),
        label: 1,
    };
    let frame = Frame::with_spacing(dimensions, [1.0, 1.0, apart]);
    let phantom = Phantom::new("", frame, vec![slab], Some(topology));
    let report = judged_phantom(&phantom);
    assert_eq!(report.connectivity.topology, topology, "{apart}: {report}");
    report
}

/// The lattice of such a sheet's points is as regular as can be, and of poor triangles.
#[test]
fn a_flat_sheet_upright_in_slices_apart_is_flat() {
    let whole = Topology {
        components: 1,
        euler: 1,
        boundary_loops: 1,
    };
    for apart in [1.3, 2.0, 3.3, 3.5] {
        let plane = Shape::Plane {
            centre: [8.0, 20.0, 20.0],
            normal: [1.0, 0.0, 0.0],
            rim: Rim::None,
            holes: Vec::new(),
        };
        let report = judged([24, 40, 40], apart, (plane, 3.0), whole);
        assert!(report.max_error < 0.1, "{apart}: {report}");
        assert!(report.smallest_angle > 25.0, "{apart}: {report}");
        assert!(report.smallest_angle_mean > 53.5, "{apart}: {report}");
        assert!(report.quality_mean > 0.93, "{apart}: {report}");
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
        let tube = Shape::Tube {
            centre: [31.7, 31.4, 0.0],
            axis: [0.0, 0.0, 1.0],
            radius: 22.0,
        };
        let report = judged([64, 64, 16], apart, (tube, 5.0), open);
        assert_eq!(report.self_intersections, 0, "{apart}: {report}");
        assert!(report.max_error < 0.6, "{apart}: {report}");
    }
}
