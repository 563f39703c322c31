//! The figures of a triangle mesh as a table: in total, of every label and of every component.
//!
//! A mesh of any origin will do: edges with more than two triangles count once, and a point that
//! no triangle uses counts for nothing. Labels and components share points only where the mesh
//! does; each row counts the points that its own triangles use. Where processes hold a piece each, they
//! measure what they have, the first one adds that up and joins what lies between them, and all find the
//! quantiles: the same table to the bit, whatever the pieces.
//!
//! | step | file |
//! | --- | --- |
//! | quality of triangles | `quality.rs` |
//! | a process's own rows; sums that are the same in any order | `measure.rs`, `exact_sum.rs` |
//! | what lies between the pieces of processes | `joints.rs` |
//! | quantiles over all | `quantiles.rs` |

mod exact_sum;
mod joints;
mod measure;
pub(crate) mod quality;
mod quantiles;

use std::collections::btree_map::{BTreeMap, Entry};

use crate::error::{collected, extend, push, Error, Result};
use crate::grid::Vec3;
use crate::processes::exchange::{taken, Alone, Exchange, Team, FIRST};
use joints::Shared;
use measure::{measure, Row};
use quality::Quality;
use quantiles::thickness_figures;

/// A triangle mesh, borrowed, with what may be known about its points and triangles.
#[derive(Debug, Clone, Copy, Default)]
pub struct TriangleMesh<'a> {
    /// Points in world coordinates.
    pub points: &'a [Vec3],
    /// Point indices, three a triangle.
    pub triangles: &'a [[i64; 3]],
    /// Thickness at each point, world units; `None`: unknown.
    pub thickness: Option<&'a [f32]>,
    /// Label of each triangle; `None`: no rows for labels.
    pub labels: Option<&'a [i64]>,
    /// Component of each triangle; `None`: no rows for components.
    pub components: Option<&'a [i64]>,
    /// Numbers of the points among those of all processes; `None`: no point is another process's, too.
    pub point_ids: Option<&'a [i64]>,
}

/// Which triangles a row is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scope {
    /// All.
    Total,
    /// Those of one label.
    Label(i64),
    /// Those of one component, of one label where labels are known.
    Component {
        /// The label.
        label: Option<i64>,
        /// The component.
        component: i64,
    },
}

/// Where in the table a row comes.
type Place = (u8, Option<i64>, Option<i64>);

impl Scope {
    fn place(self) -> Place {
        match self {
            Self::Total => (0, None, None),
            Self::Label(label) => (1, Some(label), None),
            Self::Component { label, component } => (1, label, Some(component)),
        }
    }

    /// Appends the scope to a message for another process.
    pub(crate) fn pack(self, message: &mut Vec<i64>) -> Result<()> {
        let (kind, label, component) = self.place();
        let has = i64::from(label.is_some()) + 2 * i64::from(component.is_some());
        let numbers = [label, component].map(Option::unwrap_or_default);
        extend(message, [4 * i64::from(kind) + has, numbers[0], numbers[1]])
    }

    /// Takes a scope from the beginning of a message.
    pub(crate) fn unpack(message: &mut &[i64]) -> Result<Self> {
        let [kind, label, component] = taken(message)?;
        let label = (kind & 1 != 0).then_some(label);
        Ok(match (kind / 4, label, kind & 2 != 0) {
            (0, _, _) => Self::Total,
            (_, Some(label), false) => Self::Label(label),
            _ => Self::Component { label, component },
        })
    }
}

/// Mean and quantiles of the thickness at the points, world units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ThicknessFigures {
    /// Mean over the points.
    pub mean: f64,
    /// 5 %, 25 %, 50 % (the median), 75 % and 95 % of the points are at most this thick.
    pub quantiles: [f64; 5],
}

/// A row of the table.
#[derive(Debug, Clone, PartialEq)]
pub struct Statistics {
    /// What the row is about.
    pub scope: Scope,
    /// Number of points in use.
    pub points: usize,
    /// Number of triangles.
    pub triangles: usize,
    /// Points − edges + triangles: 2 for a sphere, 1 for a disk, 0 for a torus or an open tube.
    pub euler_number: i64,
    /// Length of all edges that have one triangle, world units; 0 for a closed surface.
    pub boundary_length: f64,
    /// Number of connected rims; 0 for a closed surface.
    pub boundary_loops: usize,
    /// `None` where the thickness is not known at any of the points.
    pub thickness: Option<ThicknessFigures>,
    /// Area, shape and valence.
    pub quality: Quality,
}

/// The table: the total first, then each label, in ascending order, followed by its components.
///
/// # Errors
/// Where an array has another length than the points or triangles, an index names no point, a
/// coordinate is no number, or memory is refused.
pub fn statistics(mesh: &TriangleMesh) -> Result<Vec<Statistics>> {
    let mut alone = Alone;
    let team = &mut Team::new(&mut alone);
    measure_in_team(mesh, team)
}

/// The table of a mesh of which each of several processes holds a piece. All processes have to call
/// this at once; the first gets the table, the others an empty one.
///
/// # Errors
/// As [`statistics`], in all processes where one fails, and where several hold triangles of one
/// component, or of a mesh without components, whose points have no numbers.
pub fn statistics_of_pieces(
    mesh: &TriangleMesh,
    exchange: &mut dyn Exchange,
) -> Result<Vec<Statistics>> {
    let mut team = Team::new(exchange);
    let result = measure_in_team(mesh, &mut team);
    team.close(result)
}

fn measure_in_team(mesh: &TriangleMesh, team: &mut Team) -> Result<Vec<Statistics>> {
    check(mesh)?;
    let shared = Shared::find(mesh, team)?;
    let mut message = Vec::new();
    let mut thickness = BTreeMap::new();
    for row in measure(mesh, &shared)? {
        row.pack(&mut message)?;
        thickness.insert(row.scope.place(), row.thickness);
    }
    let of_all = team.gather(message)?;
    let mut table = added_up(&of_all, shared.are_told)?;
    drop(of_all);
    for row in table.values_mut() {
        row.join()?;
        let known = thickness.entry(row.scope.place()).or_default();
        extend(known, std::mem::take(&mut row.thickness))?;
    }
    let places = shared_places(&table, team)?;
    let lists = places.iter().map(|place| thickness.remove(place));
    let lists = collected(lists.map(Option::unwrap_or_default))?;
    let figures = thickness_figures(lists, team)?;
    let rows = table.into_values().zip(figures);
    collected(rows.map(|(row, thickness)| row.finish(thickness)))
}

/// The rows of the table, as the first process has them, in the messages of all.
fn added_up(of_all: &[Vec<i64>], are_told: bool) -> Result<BTreeMap<Place, Row>> {
    let mut table: BTreeMap<_, Row> = BTreeMap::new();
    let mut holders = 0;
    for message in of_all {
        let mut rest = message.as_slice();
        while !rest.is_empty() {
            let row = Row::unpack(&mut rest)?;
            holders += usize::from(row.scope == Scope::Total && row.shapes.triangles > 0);
            let is_whole = matches!(row.scope, Scope::Component { .. });
            match table.entry(row.scope.place()) {
                Entry::Vacant(entry) => {
                    entry.insert(row);
                }
                Entry::Occupied(_) if is_whole && !are_told => return Err(spread()),
                Entry::Occupied(mut entry) => entry.get_mut().add(row)?,
            }
        }
    }
    // Without components or numbers of points nobody can tell what hangs together.
    let has_components = table.keys().any(|(_, _, component)| component.is_some());
    if holders > 1 && !has_components && !are_told {
        return Err(spread());
    }
    Ok(table)
}

/// Lets all processes know the rows of the table that the first one has.
fn shared_places(table: &BTreeMap<Place, Row>, team: &mut Team) -> Result<Vec<Place>> {
    let mut message = Vec::new();
    for row in table.values() {
        row.scope.pack(&mut message)?;
    }
    let mut places = Vec::new();
    let of_all = team.share(&message)?;
    let mut rest = of_all[FIRST].as_slice();
    while !rest.is_empty() {
        push(&mut places, Scope::unpack(&mut rest)?.place())?;
    }
    Ok(places)
}

fn spread() -> Error {
    let text =
        "a component is spread over several processes: save the mesh to a file and open that";
    Error::Triangles(text.to_owned())
}

fn check(mesh: &TriangleMesh) -> Result<()> {
    let (points, triangles) = (mesh.points.len(), mesh.triangles.len());
    if points >= u32::MAX as usize || triangles >= u32::MAX as usize / 3 {
        return Err(Error::Triangles("there are too many of them".to_owned()));
    }
    for (name, length, needed) in [
        ("thickness", mesh.thickness.map(<[f32]>::len), points),
        ("label", mesh.labels.map(<[i64]>::len), triangles),
        ("component", mesh.components.map(<[i64]>::len), triangles),
        ("point numbers", mesh.point_ids.map(<[i64]>::len), points),
    ] {
        if length.is_some_and(|length| length != needed) {
            let text = format!("the array of the {name} has another length than the mesh needs");
            return Err(Error::Triangles(text));
        }
    }
    for (t, triangle) in mesh.triangles.iter().enumerate() {
        for &p in triangle {
            let point = usize::try_from(p).ok().and_then(|p| mesh.points.get(p));
            let Some(point) = point else {
                let text = format!("triangle {t} uses point {p}, but there are {points} points");
                return Err(Error::Triangles(text));
            };
            if !point.iter().all(|v| v.is_finite()) {
                let text = format!("point {p} has a coordinate that is no number");
                return Err(Error::Triangles(text));
            }
        }
    }
    Ok(())
}
