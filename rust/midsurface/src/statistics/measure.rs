//! The figures of a process's own triangles, row by row of the table, as sums that those
//! of other processes are added to.

use crate::error::{collected, extend, filled, push, reserved, zeros, Result};
use crate::grid::{length, sub};
use crate::processes::exchange::taken;
use crate::reading::components::DisjointSets;
use crate::statistics::exact_sum::ExactSum;
use crate::statistics::joints::{JointEdge, JointPoint, Joints, Shared};
use crate::statistics::quality::{Interior, ShapeSums, Valences};
use crate::statistics::{Scope, Statistics, ThicknessFigures, TriangleMesh};
use crate::surface::halfedge::Edges;

/// The rows of a mesh, in any order.
pub(crate) fn measure(mesh: &TriangleMesh, shared: &Shared) -> Result<Vec<Row>> {
    let mut order = collected(0..mesh.triangles.len() as u32)?;
    let label = |t: u32| mesh.labels.map(|l| l[t as usize]);
    let component = |t: u32| mesh.components.map(|c| c[t as usize]);
    order.sort_unstable_by_key(|&t| (label(t), component(t), t));

    let mut measure = Measure::new(mesh, shared)?;
    let mut total = measure.row(Scope::Total, &order)?;
    let mut rows = Vec::new();
    for triangles in order.chunk_by(|&a, &b| label(a) == label(b)) {
        let label = label(triangles[0]);
        let of_label = label.map(|label| measure.row(Scope::Label(label), triangles));
        let mut of_label = of_label.transpose()?;
        for triangles in triangles.chunk_by(|&a, &b| component(a) == component(b)) {
            let shapes = measure.shapes(triangles);
            total.shapes.add(&shapes);
            if let Some(row) = &mut of_label {
                row.shapes.add(&shapes);
            }
            if let Some(component) = component(triangles[0]) {
                let mut row = measure.row(Scope::Component { label, component }, triangles)?;
                row.shapes = shapes;
                push(&mut rows, row)?;
            }
        }
        extend(&mut rows, of_label)?;
    }
    push(&mut rows, total)?;
    Ok(rows)
}

/// Measures parts of one mesh, each with its points numbered anew, so that a part costs what it
/// holds.
struct Measure<'a> {
    mesh: &'a TriangleMesh<'a>,
    shared: &'a Shared<'a>,
    /// By point: one more than its number within the part at hand; 0 where it is not in use.
    number: Vec<u32>,
}

impl<'a> Measure<'a> {
    fn new(mesh: &'a TriangleMesh<'a>, shared: &'a Shared<'a>) -> Result<Self> {
        Ok(Self {
            mesh,
            shared,
            number: zeros(mesh.points.len())?,
        })
    }

    /// How triangles are shaped.
    fn shapes(&self, part: &[u32]) -> ShapeSums {
        let triangles = part.iter().map(|&t| self.mesh.triangles[t as usize]);
        ShapeSums::of(triangles.map(|t| t.map(|p| self.mesh.points[p as usize])))
    }

    /// The triangles of a part by their points' numbers within it, and which points these are.
    fn numbered(&mut self, part: &[u32]) -> Result<(Vec<[u32; 3]>, Vec<u32>)> {
        let mut triangles = reserved(part.len())?;
        let mut used: Vec<u32> = reserved(self.mesh.points.len().min(3 * part.len()))?;
        for &t in part {
            triangles.push(self.mesh.triangles[t as usize].map(|p| {
                let number = &mut self.number[p as usize];
                if *number == 0 {
                    used.push(p as u32);
                    *number = used.len() as u32;
                }
                *number - 1
            }));
        }
        used.iter().for_each(|&p| self.number[p as usize] = 0);
        Ok((triangles, used))
    }

    /// The row of a part, but for its shapes.
    fn row(&mut self, scope: Scope, part: &[u32]) -> Result<Row> {
        let (triangles, used) = self.numbered(part)?;
        let id = |p: u32| self.shared.id(used[p as usize] as usize);
        let edges = Edges::new(&triangles, used.len())?;
        let mut row = Row::new(scope);
        let mut valences = Valences::new(used.len())?;
        let mut chains = DisjointSets::new(used.len())?;
        for (a, b, group) in edges.groups() {
            let far = || {
                let [a, b] = [a, b].map(|p| self.mesh.points[used[p as usize] as usize]);
                length(sub(a, b))
            };
            if let (Some(first), Some(second)) = (id(a), id(b)) {
                let joint = JointEdge {
                    ends: [first.min(second), first.max(second)],
                    triangles: group.len(),
                    length: far(),
                };
                push(&mut row.joints.edges, joint)?;
                continue;
            }
            let ends = [a, b].map(|p| p as usize);
            row.edges += 1;
            valences.add(ends, group.len());
            if group.len() == 1 {
                row.boundary_length.add(far());
                chains.join(ends[0], ends[1]);
            }
        }
        self.add_points(&mut row, &used, &valences, &mut chains)?;
        Ok(row)
    }

    /// Adds the points in use to a row, and what hangs together along the boundary.
    fn add_points(
        &self,
        row: &mut Row,
        used: &[u32],
        valences: &Valences,
        chains: &mut DisjointSets,
    ) -> Result<()> {
        let id = |p: usize| self.shared.id(used[p] as usize);
        let is_chain = |p: usize| valences.on_boundary[p];
        let mut names: Vec<Option<i64>> = filled(None, used.len())?;
        for p in (0..used.len()).filter(|&p| is_chain(p)) {
            let name = &mut names[chains.find(p)];
            *name = name.or(id(p));
        }
        for (p, &point) in used.iter().enumerate() {
            let known = self.mesh.thickness.map(|known| known[point as usize]);
            let thickness = known.unwrap_or(f32::NAN);
            let chain = chains.find(p);
            if let Some(id) = id(p) {
                let joint = JointPoint {
                    id,
                    thickness,
                    edges: valences.edges[p],
                    chain: names[chain].filter(|_| is_chain(p)),
                };
                push(&mut row.joints.points, joint)?;
                continue;
            }
            row.points += 1;
            row.interior.add_point(valences, p);
            row.boundary_loops += usize::from(is_chain(p) && chain == p && names[p].is_none());
            if thickness.is_finite() {
                push(&mut row.thickness, thickness)?;
            }
        }
        Ok(())
    }
}

/// A row in the making: what adds up over the pieces of a mesh.
pub(crate) struct Row {
    pub scope: Scope,
    /// Without those that several processes have, as are edges, and all that follows from both.
    points: usize,
    edges: usize,
    boundary_length: ExactSum,
    boundary_loops: usize,
    interior: Interior,
    /// The thickness at the points where it is known.
    pub thickness: Vec<f32>,
    joints: Joints,
    pub shapes: ShapeSums,
}

impl Row {
    fn new(scope: Scope) -> Self {
        Self {
            scope,
            points: 0,
            edges: 0,
            boundary_length: ExactSum::default(),
            boundary_loops: 0,
            interior: Interior::default(),
            thickness: Vec::new(),
            joints: Joints::default(),
            shapes: ShapeSums::default(),
        }
    }

    /// Adds the same row of another process, but for the thickness.
    pub fn add(&mut self, other: Self) -> Result<()> {
        self.points += other.points;
        self.edges += other.edges;
        self.boundary_length.add_sum(&other.boundary_length);
        self.boundary_loops += other.boundary_loops;
        self.interior.add(&other.interior);
        self.shapes.add(&other.shapes);
        self.joints.append(other.joints)
    }

    /// Takes in what several processes have, when all of them have been added.
    pub fn join(&mut self) -> Result<()> {
        let joined = std::mem::take(&mut self.joints).join()?;
        self.points += joined.points;
        self.edges += joined.edges;
        self.boundary_length.add_sum(&joined.boundary_length);
        self.boundary_loops += joined.boundary_loops;
        self.interior.add(&joined.interior);
        extend(&mut self.thickness, joined.thickness)
    }

    /// The row as it is in the table.
    pub fn finish(self, thickness: Option<ThicknessFigures>) -> Statistics {
        let triangles = self.shapes.triangles;
        Statistics {
            scope: self.scope,
            points: self.points,
            triangles,
            euler_number: self.points as i64 - self.edges as i64 + triangles as i64,
            boundary_length: self.boundary_length.value(),
            boundary_loops: self.boundary_loops,
            thickness,
            quality: self.shapes.quality(&self.interior),
        }
    }

    /// Appends the row to a message for another process, without the thickness of the own points.
    pub fn pack(&self, message: &mut Vec<i64>) -> Result<()> {
        self.scope.pack(message)?;
        let Interior {
            points,
            valence_567,
        } = self.interior;
        let counts = [self.points, self.edges, self.boundary_loops];
        extend(message, counts.map(|n| n as i64))?;
        extend(message, [points, valence_567].map(|n| n as i64))?;
        self.boundary_length.pack(message)?;
        self.joints.pack(message)?;
        self.shapes.pack(message)
    }

    /// Takes a row from the beginning of a message.
    pub fn unpack(message: &mut &[i64]) -> Result<Self> {
        let scope = Scope::unpack(message)?;
        let [points, edges, boundary_loops, interior, valence_567] =
            taken(message)?.map(|n| n as usize);
        Ok(Self {
            scope,
            points,
            edges,
            boundary_loops,
            interior: Interior {
                points: interior,
                valence_567,
            },
            boundary_length: ExactSum::unpack(message)?,
            joints: Joints::unpack(message)?,
            shapes: ShapeSums::unpack(message)?,
            thickness: Vec::new(),
        })
    }
}
