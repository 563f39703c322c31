//! Parts → the surface of each, by the method chosen: in batches of whole components (`batches.rs`), or,
//! where a component is larger than a batch should be, in tiles (`tiles`).

use crate::batches::for_each_batch;
use crate::error::{self, Result};
use crate::execution::Execution;
use crate::findings::{self, Findings};
use crate::grid::Grid;
use crate::lots::Sizes;
use crate::mesh::Mesh;
use crate::processes::exchange::Team;
use crate::processes::numbering::Key;
use crate::reading::components::Part;
use crate::reading::READING;
use crate::remesh::wanted_edge;
use crate::ridge_surface::ridge_surface;
use crate::tiles::tiled_mesh::TileMesh;
use crate::tiles::tiled_surface::tiled_surface;
use crate::zipper::trace_polylines;
use crate::zipper::zipped_surface::{zipped_surface, ZIPPED};
use crate::{Method, Options};

/// The surface of components by the method chosen, and what there is to tell about it.
#[derive(Default)]
pub(crate) struct Found {
    pub mesh: Mesh,
    /// The points that other processes may have, too.
    pub shared: Vec<(Key, u32)>,
    pub findings: Findings,
}

impl Found {
    /// Adds the own tiles of a component; the first process tells where nobody has any of it.
    fn add_tiled(&mut self, lot: &[Part], tiled: TileMesh, team: &mut Team) -> Result<()> {
        let of_all = team.share(&[tiled.mesh.triangles.len() as i64])?;
        if team.process() == 0 && of_all.iter().flatten().all(|count| *count == 0) {
            self.findings.add_without(lot, &tiled.mesh);
        }
        let first = self.mesh.points.len() as u32;
        let shared = tiled.shared.into_iter();
        error::extend(&mut self.shared, shared.map(|(key, p)| (key, first + p)))?;
        self.mesh.append(tiled.mesh)
    }
}

/// Those that are worked on in tiles all processes have to have.
pub(crate) fn find_surface(
    parts: &[Part],
    grid: &Grid,
    (options, sizes): (&Options, Sizes),
    team: &mut Team,
    execution: &mut Execution,
) -> Result<Found> {
    let mut found = Found::default();
    match options.method {
        Method::PolylineZipper => {
            let findings = &mut found.findings;
            let (polylines, disks) = trace_polylines(parts, grid, execution, options.tracing())?;
            findings.disks = disks;
            let surface = zipped_surface(&polylines, findings, ZIPPED, execution)?;
            drop(polylines);
            let wanted = wanted_edge(options.edge_length, grid);
            found.mesh = surface.remeshed(grid, wanted, execution)?;
        }
        Method::RidgeSurface => {
            let size = (options.edge_length, sizes);
            find_ridge_surface(parts, grid, size, &mut found, team, execution)?;
        }
    }
    Ok(found)
}

fn find_ridge_surface(
    parts: &[Part],
    grid: &Grid,
    (edge_length, sizes): (f64, Sizes),
    found: &mut Found,
    team: &mut Team,
    execution: &mut Execution,
) -> Result<()> {
    found.findings.is_slice = grid.dimensions.contains(&1);
    if found.findings.is_slice {
        return Ok(());
    }
    let work = |parts: &[Part], execution: &mut Execution| {
        ridge_surface(parts, grid, edge_length, execution)
    };
    let all: usize = parts.iter().map(Part::voxels).sum();
    let share = |voxels: usize| READING + (1.0 - READING) * voxels as f64 / all as f64;
    let mut done = 0;
    for lot in sizes.lots(parts)? {
        let before = done;
        done += lot.iter().map(Part::voxels).sum::<usize>();
        let span = [share(before), share(done)];
        if sizes.is_tiled(lot) {
            execution.within(span[0], span[1]);
            let size = (edge_length, sizes.side);
            if let Some(tiled) = tiled_surface(lot, grid, size, team, execution)? {
                found.add_tiled(lot, tiled, team)?;
                continue;
            }
            // All processes have the component; one works on it as a whole.
            if lot[0].component as usize % team.processes() != team.process() {
                continue;
            }
        }
        for_each_batch(lot, execution, span, work, |parts, surface| {
            found.findings.add_without(parts, &surface);
            found.mesh.append(surface)
        })?;
    }
    found.findings.triangles = found.mesh.triangles.len();
    found.findings.is_far = !parts.is_empty() && findings::is_volume_far(grid);
    Ok(())
}
