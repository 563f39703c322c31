//! The stages one by one give the one click's surface, before that is remeshed.

use std::collections::BTreeSet;

use midsurface::{
    extract, mid_polylines, zip_polylines, Grid, Mesh, Method, Options, Polylines, Quiet, Volume,
};
use phantoms::*;

use crate::measure::{assert_sound, grid};

fn lines_of(labels: &[u8], grid: Grid, options: &Options) -> Polylines {
    let volume = Volume::new(labels, grid).expect("a sound volume");
    let lines = mid_polylines(&volume, options, &mut Quiet::default()).expect("polylines");
    assert_eq!(lines.check(), Ok(()), "lines of its own");
    lines
}

fn assert_chain(labels: &[u8], grid: Grid, options: &Options) {
    let volume = Volume::new(labels, grid.clone()).expect("a sound volume");
    let options = &Options {
        method: Method::PolylineZipper,
        ..options.clone()
    };
    let whole = extract(&volume, options, &mut Quiet::default()).expect("a mesh");
    let lines = lines_of(labels, grid, options);
    let zipped = zip_polylines(&lines, options, &mut Quiet::default()).expect("a mesh");
    assert_sound(&whole);
    assert!(!whole.triangles.is_empty());
    assert_same_surface(&whole, &zipped);
    let [a, b] = [&whole, &zipped].map(|mesh| mesh.quality().expect("memory").area);
    assert!((a - b).abs() <= 0.02 * a, "areas {a}, {b}");
}

/// Whether two meshes have the same pieces, of the same parts.
pub(crate) fn assert_same_surface(one: &Mesh, other: &Mesh) {
    let topology = |mesh: &Mesh| connectivity(mesh.points.len(), &mesh.triangles).topology;
    assert_eq!(topology(one), topology(other));
    let parts = |mesh: &Mesh| -> BTreeSet<_> {
        let labels = mesh.labels.iter().copied();
        labels.zip(mesh.components.iter().copied()).collect()
    };
    assert_eq!(parts(one), parts(other));
}

#[test]
fn the_chain_gives_the_same_surface() {
    let mut frame = Frame::with_spacing([40, 40, 16], [0.7, 0.7, 1.3]);
    frame.origin = [-31.7, 1e4, 0.3];
    frame.extent_start = [4, 1, -3];
    let normal = leaning(10.0, 20.0);
    let phantoms = [
        tube(Frame::new([48, 48, 12]), 17.0, 5.0),
        junction(Frame::new([40; 3]), leaning(5.0, 33.0), 4.0),
        two_sheets(frame, normal, 3.0, 0.0, [1, 2]).with_noise(0.05, 9),
    ];
    for phantom in phantoms {
        assert_chain(&phantom.labels, grid(&phantom.frame), &Options::default());
    }
    let labels = mitochondrion([96, 64, 32], 0.05, 8);
    for wanted in [None, Some(vec![i64::from(INNER)])] {
        let options = Options {
            labels: wanted,
            ..Options::default()
        };
        assert_chain(&labels, Grid::new([96, 64, 32]), &options);
    }
}

#[test]
fn lines_lie_in_their_slices() {
    let mut frame = Frame::with_spacing([40, 40, 16], [0.7, 0.7, 1.3]);
    frame.extent_start = [4, 1, -3];
    frame.origin = [5.0, 6.0, 7.0];
    let phantom = sheet(frame, leaning(10.0, 20.0), 4.0, &[]);
    let lines = lines_of(&phantom.labels, grid(&phantom.frame), &Options::default());
    assert_eq!(lines.points.len(), lines.thickness.len());
    let mut next = 0;
    for line in &lines.lines {
        assert_eq!(line.first, next, "lines lie one after the other");
        next += line.count;
        for p in &lines.points[line.first..next] {
            assert!((p[2] - (7.0 + 1.3 * line.slice as f64)).abs() < 1e-9);
        }
    }
    assert_eq!(next, lines.points.len());
}
