//! Rims that noise has made ragged.

use crate::phantoms_known::judged;

#[test]
fn sheets_are_not_led_astray_from_between_the_spurs_of_a_ragged_rim() {
    for (name, seed) in [
        ("cap 2 thick", 5),
        ("cap 2 thick", 9),
        ("disk with a hole, 2 thick", 3),
        ("disk with a hole, 2 thick", 7),
    ] {
        let (_, phantom, report) = judged(name, seed, true);
        let expected = phantom.topology.expect("a topology");
        assert_eq!(
            report.connectivity.topology, expected,
            "{name} {seed}: {report}"
        );
        assert!(report.max_error < 0.6, "{name} {seed}: {report}");
    }
}

/// Four slices, far apart: those off the middle say where it is, too, and sheets are led on from all.
#[test]
fn thick_sheets_lying_in_slices_apart_are_led_on_to_their_rims() {
    let (_, phantom, report) = judged("disk lying in slices apart", 9, true);
    let expected = phantom.topology.expect("a topology");
    assert_eq!(report.connectivity.topology, expected, "{report}");
    assert_eq!(report.covered_within_1, 1.0, "{report}");
}
