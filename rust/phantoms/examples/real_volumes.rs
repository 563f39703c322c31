//! Extracts the mid-surfaces of the real segmentations that lie beside the checkout in
//! ../shared/data, and prints how the meshes lie within their labels, one line each.
//!
//! `cargo run -p phantoms --release --example real_volumes -- [zipper|ridge] [PART OF A NAME]`
//!
//! With `--write FOLDER` the meshes are written there (.ply).

#[path = "../../midsurface/tests/extraction/image_file.rs"]
mod image_file;

use std::fs::File;
use std::io::BufWriter;
use std::path::Path;
use std::time::Instant;

use midsurface::{extract, Grid, Mesh, Method, Options, Quiet, Volume};
use phantoms::{connectivity, mask_fit, self_intersections, shapes, write_ply, Frame};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut words: Vec<String> = std::env::args().skip(1).collect();
    let write = words.iter().position(|w| w == "--write");
    let folder = write.map(|at| {
        words
            .drain(at..at + 2)
            .nth(1)
            .expect("--write needs a folder")
    });
    let method = if words.iter().any(|w| w == "zipper") {
        Method::PolylineZipper
    } else {
        Method::RidgeSurface
    };
    let part = words.iter().find(|w| *w != "zipper" && *w != "ridge");
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    for name in ["Fig13A", "Fig13B", "Fig7", "Fig11-OMM", "Fig11-IMM"] {
        let path = data.join(name).with_extension("vti");
        if part.is_some_and(|part| !name.contains(part.as_str())) {
            continue;
        }
        if path.exists() {
            let (labels, grid) = image_file::read(&path);
            let (mesh, seconds) = extract_timed(&labels, &grid, method)?;
            println!(
                "{name:10} {seconds:6.2} s {}",
                figures(&mesh, &labels, &grid)
            );
            if let Some(folder) = &folder {
                let file = File::create(Path::new(folder).join(name).with_extension("ply"))?;
                write_ply(&mut BufWriter::new(file), &mesh.points, &mesh.triangles)?;
            }
        } else {
            println!("skipped: {} is not there", path.display());
        }
    }
    Ok(())
}

fn extract_timed(
    labels: &[u8],
    grid: &Grid,
    method: Method,
) -> Result<(Mesh, f64), midsurface::Error> {
    let volume = Volume::new(labels, grid.clone())?;
    let options = Options {
        method,
        ..Options::default()
    };
    let start = Instant::now();
    let mesh = extract(&volume, &options, &mut Quiet::default())?;
    Ok((mesh, start.elapsed().as_secs_f64()))
}

fn figures(mesh: &Mesh, labels: &[u8], grid: &Grid) -> String {
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
    format!(
        "{:7} triangles, off-centre {:.3} (95 %: {:.2}) covered {:.2} % excess \
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
    )
}
