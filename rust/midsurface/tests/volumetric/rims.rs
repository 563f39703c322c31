//! Rims of thin sheets that noise has made ragged.

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
