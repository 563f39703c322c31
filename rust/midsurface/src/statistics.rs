//! The figures of a triangle mesh as a table: in total, of every label and of every component.
//!
//! A mesh of any origin will do: edges with more than two triangles count once, and a point that
//! no triangle uses counts for nothing. Labels and components share points only where the mesh
//! does; each row counts the points that its own triangles use.

use crate::error::{reserved, zeros, Error, Result};
use crate::grid::{length, sub, Vec3};
use crate::halfedge::Edges;
use crate::quality::{valence_567, Quality};

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
    check(mesh)?;
    let mut order = reserved(mesh.triangles.len())?;
    order.extend(0..mesh.triangles.len() as u32);
    let label = |t: u32| mesh.labels.map(|l| l[t as usize]);
    let component = |t: u32| mesh.components.map(|c| c[t as usize]);
    order.sort_by_key(|&t| (label(t), component(t)));

    let mut measure = Measure::new(mesh)?;
    let mut rows = vec![measure.row(Scope::Total, &order)?];
    for of_label in order.chunk_by(|&a, &b| label(a) == label(b)) {
        let label = label(of_label[0]);
        if let Some(label) = label {
            rows.push(measure.row(Scope::Label(label), of_label)?);
        }
        for triangles in of_label.chunk_by(|&a, &b| component(a) == component(b)) {
            if let Some(component) = component(triangles[0]) {
                rows.push(measure.row(Scope::Component { label, component }, triangles)?);
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

    fn row(&mut self, scope: Scope, part: &[u32]) -> Result<Statistics> {
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
        let edges = Edges::new(&triangles, used.len());
        let boundary: Vec<(u32, u32)> = edges
            .groups()
            .filter(|(_, _, group)| group.len() == 1)
            .map(|(a, b, _)| (a, b))
            .collect();
        let corners = triangles.iter().map(|t: &[u32; 3]| t.map(point));
        Ok(Statistics {
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
            quality: Quality {
                valence_567: valence_567(&edges, used.len()),
                ..Quality::of_shapes(corners)
            },
        })
    }

    fn thickness(&self, used: &[usize]) -> Result<Option<ThicknessFigures>> {
        let Some(thickness) = self.mesh.thickness else {
            return Ok(None);
        };
        let mut known: Vec<f64> = reserved(used.len())?;
        known.extend(
            used.iter()
                .map(|&p| f64::from(thickness[p]))
                .filter(|t| t.is_finite()),
        );
        known.sort_by(f64::total_cmp);
        Ok((!known.is_empty()).then(|| ThicknessFigures {
            mean: known.iter().sum::<f64>() / known.len() as f64,
            quantiles: QUANTILES.map(|share| quantile(&known, share)),
        }))
    }
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
    let mut parent: Vec<u32> = reserved(points)?;
    parent.extend(0..points as u32);
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
