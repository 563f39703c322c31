//! The figures of a triangle mesh as a table: in total, of every label and of every component.
//!
//! A mesh of any origin will do: edges with more than two triangles count once, and a point that
//! no triangle uses counts for nothing. Labels and components share points only where the mesh
//! does; each row counts the points that its own triangles use. Where processes hold a piece each, a
//! component that several hold is first put together (`regroup.rs`), and in the end the first process adds
//! up what the others measured.

use std::collections::BTreeMap;

use crate::error::{collected, extend, push, reserve, reserved, zeros, Error, Result};
use crate::exchange::{Exchange, Team};
use crate::grid::{length, sub, Vec3};
use crate::halfedge::Edges;
use crate::quality::{Quality, QualitySums};
use crate::regroup::{regrouped, Regrouped};

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

impl Scope {
    /// Where in the table the row comes.
    fn place(self) -> (u8, Option<i64>, Option<i64>) {
        match self {
            Self::Total => (0, None, None),
            Self::Label(label) => (1, Some(label), None),
            Self::Component { label, component } => (1, label, Some(component)),
        }
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

const QUANTILES: [f64; 5] = [0.05, 0.25, 0.5, 0.75, 0.95];

/// The table: the total first, then each label, in ascending order, followed by its components.
///
/// # Errors
/// Where an array has another length than the points or triangles, an index names no point, a
/// coordinate is no number, or memory is refused.
pub fn statistics(mesh: &TriangleMesh) -> Result<Vec<Statistics>> {
    Ok(measure(mesh)?.into_iter().map(Row::finish).collect())
}

/// The table of a mesh of which each of several processes holds a piece. All processes have to call
/// this at once; the first gets the table, the others an empty one.
///
/// # Errors
/// As [`statistics`], in all processes where one fails, and where several hold triangles of one
/// component whose points have no numbers, or of a mesh without components.
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
    let regrouped = regrouped(mesh, team)?;
    let own = regrouped.as_ref().map(Regrouped::mesh);
    let mut message = Vec::new();
    for row in measure(own.as_ref().unwrap_or(mesh))? {
        row.pack(&mut message)?;
    }
    let of_all = team.gather(message)?;
    let mut table: BTreeMap<_, Row> = BTreeMap::new();
    let mut holders = 0;
    for message in &of_all {
        let mut rest = message.as_slice();
        while let Some(row) = Row::unpack(&mut rest) {
            let row = row?;
            let key = row.scope.place();
            let is_whole = matches!(row.scope, Scope::Component { .. });
            holders += usize::from(row.scope == Scope::Total && row.triangles > 0);
            match table.remove(&key) {
                None => table.insert(key, row),
                Some(_) if is_whole => return Err(spread()),
                Some(before) => table.insert(key, before.add(row)?),
            };
        }
    }
    // Without components nobody can tell what hangs together.
    if holders > 1 && table.keys().all(|(_, _, component)| component.is_none()) {
        return Err(spread());
    }
    Ok(table.into_values().map(Row::finish).collect())
}

fn spread() -> Error {
    let text =
        "a component is spread over several processes: save the mesh to a file and open that";
    Error::Triangles(text.to_owned())
}

fn measure(mesh: &TriangleMesh) -> Result<Vec<Row>> {
    check(mesh)?;
    let mut order = collected(0..mesh.triangles.len() as u32)?;
    let label = |t: u32| mesh.labels.map(|l| l[t as usize]);
    let component = |t: u32| mesh.components.map(|c| c[t as usize]);
    order.sort_unstable_by_key(|&t| (label(t), component(t), t));

    let mut measure = Measure::new(mesh)?;
    let mut rows = vec![measure.row(Scope::Total, &order)?];
    for of_label in order.chunk_by(|&a, &b| label(a) == label(b)) {
        let label = label(of_label[0]);
        if let Some(label) = label {
            push(&mut rows, measure.row(Scope::Label(label), of_label)?)?;
        }
        for triangles in of_label.chunk_by(|&a, &b| component(a) == component(b)) {
            if let Some(component) = component(triangles[0]) {
                let scope = Scope::Component { label, component };
                push(&mut rows, measure.row(scope, triangles)?)?;
            }
        }
    }
    Ok(rows)
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

/// Measures parts of one mesh, each with its points numbered anew, so that a part costs what it
/// holds.
struct Measure<'a> {
    mesh: &'a TriangleMesh<'a>,
    /// By point: one more than its number within the part at hand; 0 where it is not in use.
    number: Vec<u32>,
}

impl<'a> Measure<'a> {
    fn new(mesh: &'a TriangleMesh<'a>) -> Result<Self> {
        Ok(Self {
            mesh,
            number: zeros(mesh.points.len())?,
        })
    }

    fn row(&mut self, scope: Scope, part: &[u32]) -> Result<Row> {
        let mut triangles = reserved(part.len())?;
        let mut used: Vec<usize> = reserved(self.mesh.points.len().min(3 * part.len()))?;
        for &t in part {
            triangles.push(self.mesh.triangles[t as usize].map(|p| {
                let number = &mut self.number[p as usize];
                if *number == 0 {
                    used.push(p as usize);
                    *number = used.len() as u32;
                }
                *number - 1
            }));
        }
        for &p in &used {
            self.number[p] = 0;
        }
        let point = |p: u32| self.mesh.points[used[p as usize]];
        let edges = Edges::new(&triangles, used.len())?;
        let boundary = edges.groups().filter(|(_, _, group)| group.len() == 1);
        let boundary = collected(boundary.map(|(a, b, _)| (a, b)))?;
        let corners = triangles.iter().map(|t: &[u32; 3]| t.map(point));
        Ok(Row {
            scope,
            points: used.len(),
            triangles: triangles.len(),
            euler_number: used.len() as i64 - edges.groups().count() as i64
                + triangles.len() as i64,
            boundary_length: boundary
                .iter()
                .map(|&(a, b)| length(sub(point(a), point(b))))
                .sum(),
            boundary_loops: count_connected(&boundary, used.len())?,
            thickness: self.thickness(&used)?,
            quality: QualitySums::of(corners, &edges, used.len())?,
        })
    }

    /// The thickness where it is known.
    fn thickness(&self, used: &[usize]) -> Result<Vec<f64>> {
        let Some(thickness) = self.mesh.thickness else {
            return Ok(Vec::new());
        };
        let known = used.iter().map(|&p| f64::from(thickness[p]));
        collected(known.filter(|t| t.is_finite()))
    }
}

/// A row in the making: what adds up over the pieces of a mesh.
struct Row {
    scope: Scope,
    points: usize,
    triangles: usize,
    euler_number: i64,
    boundary_length: f64,
    boundary_loops: usize,
    thickness: Vec<f64>,
    quality: QualitySums,
}

impl Row {
    fn add(mut self, other: Self) -> Result<Self> {
        extend(&mut self.thickness, other.thickness)?;
        Ok(Self {
            points: self.points + other.points,
            triangles: self.triangles + other.triangles,
            euler_number: self.euler_number + other.euler_number,
            boundary_length: self.boundary_length + other.boundary_length,
            boundary_loops: self.boundary_loops + other.boundary_loops,
            quality: self.quality.add(&other.quality),
            ..self
        })
    }

    fn finish(mut self) -> Statistics {
        let known = &mut self.thickness;
        known.sort_unstable_by(f64::total_cmp);
        let thickness = (!known.is_empty()).then(|| ThicknessFigures {
            mean: known.iter().sum::<f64>() / known.len() as f64,
            quantiles: QUANTILES.map(|share| quantile(known, share)),
        });
        Statistics {
            scope: self.scope,
            points: self.points,
            triangles: self.triangles,
            euler_number: self.euler_number,
            boundary_length: self.boundary_length,
            boundary_loops: self.boundary_loops,
            thickness,
            quality: self.quality.quality(),
        }
    }

    /// Appends the row to a message for another process; floats go as their bits.
    fn pack(&self, message: &mut Vec<i64>) -> Result<()> {
        let (kind, label, component) = self.scope.place();
        reserve(message, 9 + QualitySums::LENGTH + self.thickness.len())?;
        let counts = [
            self.points,
            self.triangles,
            self.boundary_loops,
            self.thickness.len(),
        ];
        let has = i64::from(label.is_some()) + 2 * i64::from(component.is_some());
        message.extend([
            4 * i64::from(kind) + has,
            label.unwrap_or(0),
            component.unwrap_or(0),
        ]);
        message.extend(counts.map(|n| n as i64));
        message.push(self.euler_number);
        let floats = [self.boundary_length]
            .into_iter()
            .chain(self.quality.numbers());
        message.extend(floats.chain(self.thickness.iter().copied()).map(to_bits));
        Ok(())
    }

    /// Takes a row from the beginning of a message.
    fn unpack(message: &mut &[i64]) -> Option<Result<Self>> {
        let (head, rest) = message.split_first_chunk::<8>()?;
        let [scope, label, component, points, triangles, loops, known, euler_number] = *head;
        let (floats, rest) = rest.split_first_chunk::<{ 1 + QualitySums::LENGTH }>()?;
        let (thickness, rest) = rest.split_at_checked(known as usize)?;
        *message = rest;
        let label = (scope & 1 != 0).then_some(label);
        let floats = floats.map(from_bits);
        let thickness = collected(thickness.iter().copied().map(from_bits));
        Some(thickness.map(|thickness| Self {
            scope: match (scope / 4, label, scope & 2 != 0) {
                (0, _, _) => Scope::Total,
                (_, Some(label), false) => Scope::Label(label),
                _ => Scope::Component { label, component },
            },
            points: points as usize,
            triangles: triangles as usize,
            euler_number,
            boundary_length: floats[0],
            boundary_loops: loops as usize,
            thickness,
            quality: QualitySums::from(std::array::from_fn(|i| floats[1 + i])),
        }))
    }
}

fn to_bits(value: f64) -> i64 {
    value.to_bits() as i64
}

fn from_bits(bits: i64) -> f64 {
    f64::from_bits(bits as u64)
}

/// The quantile of ascending values, linear between neighbours.
fn quantile(ascending: &[f64], share: f64) -> f64 {
    let place = share * (ascending.len() - 1) as f64;
    let below = place.floor() as usize;
    let above = (below + 1).min(ascending.len() - 1);
    let t = place - below as f64;
    ascending[below] * (1.0 - t) + ascending[above] * t
}

/// Number of connected parts of a graph, among its points that have an edge.
fn count_connected(edges: &[(u32, u32)], points: usize) -> Result<usize> {
    let mut parent = collected(0..points as u32)?;
    let mut touched: Vec<bool> = zeros(points)?;
    let mut joins = 0;
    for &(a, b) in edges {
        touched[a as usize] = true;
        touched[b as usize] = true;
        let (a, b) = (root(&mut parent, a), root(&mut parent, b));
        if a != b {
            parent[a.max(b) as usize] = a.min(b);
            joins += 1;
        }
    }
    Ok(touched.iter().filter(|t| **t).count() - joins)
}

/// The representative of a point; halves the way to it. A parent is never the larger one, so it
/// ends.
fn root(parent: &mut [u32], mut p: u32) -> u32 {
    while parent[p as usize] != p {
        let grandparent = parent[parent[p as usize] as usize];
        parent[p as usize] = grandparent;
        p = grandparent;
    }
    p
}
