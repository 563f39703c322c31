//! Extracts the mid-surfaces of the real segmentations that lie beside the checkout in
//! ../shared/data, and prints how the meshes lie within their labels, one line each.
//!
//! `cargo run -p phantoms --release --example real_volumes -- [zipper|ridge] [PART OF A NAME]`

#[path = "../../midsurface/tests/extraction/image_file.rs"]
mod image_file;

use std::path::Path;
use std::time::Instant;

use midsurface::{extract, Grid, Method, Options, Quiet, Volume};
use phantoms::{connectivity, mask_fit, self_intersections, shapes, Frame};

fn main() -> Result<(), midsurface::Error> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let method = if words.iter().any(|w| w == "zipper") {
        Method::PolylineZipper
    } else {
        Method::RidgeSurface
    };
    let part = words.iter().find(|w| *w != "zipper" && *w != "ridge");
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    for name in ["Fig13A", "Fig13B", "Fig7", "Fig11-OMM", "Fig11-IMM"] {
        let path = folder.join(name).with_extension("vti");
        if part.is_some_and(|part| !name.contains(part.as_str())) {
            continue;
        }
        if path.exists() {
            let (labels, grid) = image_file::read(&path);
            println!("{name:10} {}", measure(&labels, &grid, method)?);
        } else {
            println!("skipped: {} is not there", path.display());
        }
    }
    Ok(())
}

fn measure(labels: &[u8], grid: &Grid, method: Method) -> Result<String, midsurface::Error> {
    let volume = Volume::new(labels, grid.clone())?;
    let options = Options {
        method,
        ..Options::default()
    };
    let start = Instant::now();
    let mesh = extract(&volume, &options, &mut Quiet::default())?;
    let seconds = start.elapsed().as_secs_f64();

    let frame = Frame {
        dimensions: grid.dimensions,
        extent_start: grid.extent_start,
        spacing: grid.spacing,
        origin: grid.origin,
        direction: grid.direction,
    };
    let labelled: Vec<bool> = labels.iter().map(|&l| l != 0).collect();
    let fit = mask_fit(&mesh.points, &mesh.triangles, &labelled, &frame);
    let counted = connectivity(mesh.points.len(), &mesh.triangles);
    let corners = |t: &[u32; 3]| t.map(|v| mesh.points[v as usize].map(f64::from));
    let shapes = shapes(&mesh.triangles.iter().map(corners).collect::<Vec<_>>());
    let crossings = self_intersections(&mesh.points, &mesh.triangles);
    let labels_parts = 1 + mesh.components.iter().max().copied().unwrap_or(0);
    Ok(format!(
        "{seconds:6.2} s {:7} triangles, off-centre {:.3} (95 %: {:.2}) covered {:.2} % excess \
         {:.3} % inside {:.2} %, {labels_parts} label parts, {} components Euler {} loops {}, \
         {} self-intersections {} non-manifold {} pinched {} misoriented, \
         Q {:.3} min {:.2} angle {:.1} min {:.0} (<30: {} >120: {}) V567 {:.2} V6 {:.1} %",
        mesh.triangles.len(),
        fit.off_centre_mean,
        fit.off_centre_95,
        100.0 * fit.covered,
        100.0 * fit.excess,
        100.0 * fit.inside,
        counted.topology.components,
        counted.topology.euler,
        counted.topology.boundary_loops,
        crossings.len(),
        counted.nonmanifold_edges,
        counted.pinched_vertices,
        counted.misoriented_edges,
        shapes.quality_mean,
        shapes.quality_least,
        shapes.smallest_angle_mean,
        shapes.smallest_angle,
        shapes.angles_under_30,
        shapes.angles_over_120,
        100.0 * counted.valence_567,
        100.0 * counted.valence_6,
    ))
}
