//! The ridge surface from outside: on phantoms whose mid-surface is known, clean and noisy, on real
//! volumes, and where there is none. One program, so that it is linked once.

mod borders;
#[path = "../extraction/image_file.rs"]
mod image_file;
mod junctions;
mod phantoms_known;
mod real_volumes;
mod rims;
mod spacings;
mod warnings;

use midsurface::{extract, Grid, Mesh, Method, Options, Quiet, Volume};

/// The ridge surface of all labels. What holds for every mesh is asserted.
fn ridge_surface(labels: &[u8], grid: Grid) -> Mesh {
    let volume = Volume::new(labels, grid).expect("a sound volume");
    let options = Options {
        method: Method::RidgeSurface,
        ..Options::default()
    };
    let mesh = extract(&volume, &options, &mut Quiet::default()).expect("a mesh");
    assert_eq!(mesh.check_invariants(), Ok(()));
    mesh
}
