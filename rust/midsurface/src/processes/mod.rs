//! What each of several processes calls that hold a volume in pieces.
//!
//! All processes have to call the same function at once, with the same options and the same `whole`,
//! which tells where the voxels of the whole volume lie; threads may differ. Pieces may overlap, and
//! may be `None`. Where one process fails, all do. Warnings about the whole go to the observer of the
//! first process.
//!
//! | step | file |
//! | --- | --- |
//! | how processes talk, and agree on failure | `exchange.rs` |
//! | which voxels are whose, and components that are whole on one of them | `territory.rs`, `pieces.rs` |
//! | numbers of points and triangles among those of all | `numbering.rs` |

pub(crate) mod exchange;
pub(crate) mod numbering;
mod pieces;
mod territory;

use ndarray::ArrayViewMut3;

use crate::error::{collected, Error, Result};
use crate::execution::{Collected, Execution, Observer};
use crate::extraction::find_surface;
use crate::findings::Findings;
use crate::grid::Grid;
use crate::lots::Sizes;
use crate::mesh::Mesh;
use crate::reading::volume::Volume;
use crate::zipper::polylines::Polylines;
use crate::zipper::zipped_surface::zipped_surface;
use crate::zipper::{trace_polylines, write_fields, Fields};
use crate::{Method, Options};
use exchange::{Exchange, Team};
use numbering::{first_of_own, point_ids, Key};
use pieces::{gather_parts, Share};

/// The part of a mesh that one process holds.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct MeshPiece {
    /// Points and triangles, numbered from 0.
    pub mesh: Mesh,
    /// Numbers of the points among those of all processes. A point of a component that several processes
    /// share may be another one's, too: it is the same to the bit, and has the same number.
    pub point_ids: Vec<i64>,
    /// Number of the first triangle among those of all processes. No triangle is another process's, too.
    pub first_triangle: u64,
}

/// The mid-surface. Each process gets the mesh of whole components, as [`crate::extract`] numbers
/// them, and a part of the mesh of each that is too large for one; all of them together are what that
/// makes of the whole volume.
///
/// # Errors
/// As [`crate::extract`], and where the pieces do not make up the whole or the options differ.
pub fn extract_piece(
    piece: Option<&Volume>,
    whole: &Grid,
    options: &Options,
    exchange: &mut dyn Exchange,
    observer: &mut dyn Observer,
) -> Result<MeshPiece> {
    extract_piece_in(piece, whole, (options, Sizes::USUAL), exchange, observer)
}

/// The same, with components of any size in tiles.
pub(crate) fn extract_piece_in(
    piece: Option<&Volume>,
    whole: &Grid,
    (options, sizes): (&Options, Sizes),
    exchange: &mut dyn Exchange,
    observer: &mut dyn Observer,
) -> Result<MeshPiece> {
    in_team(options, exchange, observer, |team, execution| {
        execution.within(0.0, options.tracing());
        let most = match options.method {
            Method::PolylineZipper => usize::MAX,
            Method::RidgeSurface => sizes.most_voxels,
        };
        let parts = gather_parts(piece, whole, options, Share::One(most), team, execution)?;
        let found = find_surface(&parts, whole, (options, sizes), team, execution)?;
        let piece = numbered(found.mesh, &found.shared, team)?;
        Ok((piece, found.findings))
    })
}

/// The mid-polylines, of whole components as for [`extract_piece`].
///
/// # Errors
/// As [`extract_piece`].
pub fn mid_polylines_piece(
    piece: Option<&Volume>,
    whole: &Grid,
    options: &Options,
    exchange: &mut dyn Exchange,
    observer: &mut dyn Observer,
) -> Result<Polylines> {
    in_team(options, exchange, observer, |team, execution| {
        let parts = gather_parts(
            piece,
            whole,
            options,
            Share::One(usize::MAX),
            team,
            execution,
        )?;
        let (polylines, disks) = trace_polylines(&parts, whole, execution, 1.0)?;
        let findings = Findings {
            disks,
            ..Findings::default()
        };
        Ok((polylines, findings))
    })
}

/// Joins the polylines of neighbouring slices. The lines of a component have to be on one process, as
/// those of [`mid_polylines_piece`] are.
///
/// # Errors
/// As [`crate::zip_polylines`], and where several processes have lines of one component.
pub fn zip_polylines_piece(
    polylines: &Polylines,
    options: &Options,
    exchange: &mut dyn Exchange,
    observer: &mut dyn Observer,
) -> Result<MeshPiece> {
    in_team(options, exchange, observer, |team, execution| {
        polylines.check()?;
        check_held_by_one(polylines, team)?;
        let mut findings = Findings::default();
        let mesh =
            zipped_surface(polylines, &mut findings, 1.0, execution)?.into_mesh(execution)?;
        Ok((numbered(mesh, &[], team)?, findings))
    })
}

/// Writes distance and ridge field, both in world units, into arrays of the piece's shape (z, y, x),
/// as [`crate::ridge_field`] does for the whole. A process works on all components near its piece.
///
/// # Errors
/// As [`extract_piece`].
pub fn ridge_field_piece(
    piece: Option<&Volume>,
    whole: &Grid,
    options: &Options,
    exchange: &mut dyn Exchange,
    observer: &mut dyn Observer,
    mut distance: ArrayViewMut3<f32>,
    mut ridge: ArrayViewMut3<f32>,
) -> Result<()> {
    in_team(options, exchange, observer, |team, execution| {
        let parts = gather_parts(piece, whole, options, Share::Near, team, execution)?;
        let start = piece.map_or(whole.extent_start, |volume| volume.grid.extent_start);
        let mut fields = Fields {
            distance: distance.view_mut(),
            ridge: ridge.view_mut(),
            // Checked to lie in the whole.
            first: std::array::from_fn(|a| (start[a] - whole.extent_start[a]) as usize),
        };
        write_fields(&parts, whole, &mut fields, execution)?;
        Ok(((), Findings::default()))
    })
}

/// Runs `work` together with the other processes, and tells the first one's user what all have found.
fn in_team<T>(
    options: &Options,
    exchange: &mut dyn Exchange,
    observer: &mut dyn Observer,
    work: impl FnOnce(&mut Team, &mut Execution) -> Result<(T, Findings)>,
) -> Result<T> {
    let mut warnings = Collected::new(observer);
    let mut team = Team::new(exchange);
    let is_first = team.is_first();
    let result = agreed(options, &mut team, &mut warnings, work);
    let result = team.close(result);
    if is_first {
        warnings.pass_on();
    }
    result
}

fn agreed<T>(
    options: &Options,
    team: &mut Team,
    warnings: &mut Collected,
    work: impl FnOnce(&mut Team, &mut Execution) -> Result<(T, Findings)>,
) -> Result<T> {
    options.check()?;
    check_options(options, team)?;
    let mut execution = Execution::new(options.threads, warnings)?;
    let (result, findings) = work(team, &mut execution)?;
    let of_all = team.gather(findings.pack())?;
    let mut findings = Findings::default();
    for of_process in &of_all {
        findings.add(&Findings::unpack(of_process));
    }
    findings.warn(&mut execution);
    execution.finish()?;
    warnings.gather(team)?;
    Ok(result)
}

/// All processes learn whether they are told to do the same.
fn check_options(options: &Options, team: &mut Team) -> Result<()> {
    let mut own = vec![
        options.method as i64,
        options.edge_length.to_bits() as i64,
        i64::from(options.labels.is_some()),
    ];
    own.extend(options.labels.iter().flatten());
    let of_all = team.share(&own)?;
    if of_all.iter().all(|of_process| *of_process == own) {
        Ok(())
    } else {
        Err(Error::OptionsDiffer)
    }
}

/// All processes learn whether the lines of each component are on one of them.
fn check_held_by_one(polylines: &Polylines, team: &mut Team) -> Result<()> {
    let of_line = polylines.lines.iter();
    let mut own = collected(of_line.map(|line| [line.label, line.component.into()]))?;
    own.sort_unstable();
    own.dedup();
    let of_all = team.gather(own.concat())?;
    let mut all = collected(of_all.iter().flat_map(|own| own.chunks_exact(2)))?;
    all.sort_unstable();
    match all.windows(2).find(|pair| pair[0] == pair[1]) {
        None => Ok(()),
        Some(pair) => Err(Error::Polylines(format!(
            "several processes have lines of component {} of label {}; those of a component have to \
             be on one, as Mid-Polylines leaves them",
            pair[0][1], pair[0][0]
        ))),
    }
}

/// A process's mesh, with the numbers among those of all.
fn numbered(mesh: Mesh, shared: &[(Key, u32)], team: &mut Team) -> Result<MeshPiece> {
    Ok(MeshPiece {
        point_ids: point_ids(mesh.points.len(), shared, team)?,
        first_triangle: first_of_own(mesh.triangles.len(), team)? as u64,
        mesh,
    })
}
