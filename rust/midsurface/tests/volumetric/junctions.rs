//! Where sheets meet, at other places than the usual ones.

use phantoms::Topology;

use crate::phantoms_known::judged;

#[test]
fn sheets_that_meet_at_a_small_angle_are_three_disks() {
    let three_disks = Topology {
        components: 3,
        euler: 3,
        boundary_loops: 3,
    };
    for seed in 2..5 {
        for noisy in [false, true] {
            let (_, _, report) = judged("junction Y, narrow", seed, noisy);
            let found = report.connectivity.topology;
            assert_eq!(found, three_disks, "seed {seed}:\n{report}");
        }
    }
}
