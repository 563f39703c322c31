//! What the pieces of a mesh have in common: points that several processes have, and edges between these.
//!
//! Of these no process alone can tell how many there are, whether they are on the boundary, and what
//! hangs together there. So each tells what it has at them, and the first process joins that. They are few:
//! those where tiles of a component meet that is shared.

use crate::error::{collected, extend, push, Error, Result};
use crate::processes::exchange::{taken, Team};
use crate::reading::components::DisjointSets;
use crate::statistics::exact_sum::ExactSum;
use crate::statistics::quality::{Interior, Valences};
use crate::statistics::TriangleMesh;

/// The own points that other processes have, too.
pub(crate) struct Shared<'a> {
    ids: &'a [i64],
    is_shared: Vec<bool>,
    /// Whether all processes know the numbers of their points.
    pub are_told: bool,
}

impl<'a> Shared<'a> {
    /// Lets all processes find out: of each number one of them is told who has it.
    pub fn find(mesh: &TriangleMesh<'a>, team: &mut Team) -> Result<Self> {
        let is_told = mesh.triangles.is_empty() || mesh.point_ids.is_some();
        let told = team.share(&[i64::from(is_told)])?;
        let mut found = Self {
            ids: mesh.point_ids.unwrap_or_default(),
            is_shared: Vec::new(),
            are_told: told.iter().flatten().all(|told| *told == 1),
        };
        if !found.are_told || team.processes() == 1 {
            return Ok(found);
        }
        let mut messages = vec![Vec::new(); team.processes()];
        for &id in found.ids {
            push(&mut messages[id.rem_euclid(told.len() as i64) as usize], id)?;
        }
        let mut holders = Vec::new();
        for (process, ids) in team.swap(messages)?.into_iter().enumerate() {
            extend(&mut holders, ids.into_iter().map(|id| (id, process)))?;
        }
        holders.sort_unstable();
        holders.dedup();
        let mut answers = vec![Vec::new(); team.processes()];
        let of_ids = holders.chunk_by(|a, b| a.0 == b.0);
        for &(id, process) in of_ids.filter(|of_id| of_id.len() > 1).flatten() {
            push(&mut answers[process], id)?;
        }
        drop(holders);
        let mut shared = Vec::new();
        for ids in team.swap(answers)? {
            extend(&mut shared, ids)?;
        }
        shared.sort_unstable();
        let is_shared = |id: &i64| shared.binary_search(id).is_ok();
        found.is_shared = collected(found.ids.iter().map(is_shared))?;
        Ok(found)
    }

    /// The number of a point that is shared.
    pub fn id(&self, p: usize) -> Option<i64> {
        let is_shared = self.is_shared.get(p).copied().unwrap_or(false);
        is_shared.then(|| self.ids[p])
    }
}

/// What a process has at a shared point.
pub(crate) struct JointPoint {
    pub id: i64,
    pub thickness: f32,
    /// Edges that are no joint edges.
    pub edges: u32,
    /// Where one of these is on the boundary, the number of a point that stands for all that hangs together
    /// there.
    pub chain: Option<i64>,
}

/// An edge between shared points.
pub(crate) struct JointEdge {
    /// The smaller number first.
    pub ends: [i64; 2],
    /// How many triangles of the process have it.
    pub triangles: usize,
    pub length: f64,
}

/// Those of some triangles.
#[derive(Default)]
pub(crate) struct Joints {
    pub points: Vec<JointPoint>,
    pub edges: Vec<JointEdge>,
}

/// What joints of all processes come to.
#[derive(Default)]
pub(crate) struct Joined {
    pub points: usize,
    pub edges: usize,
    pub boundary_length: ExactSum,
    pub boundary_loops: usize,
    pub interior: Interior,
    /// Where it is known.
    pub thickness: Vec<f32>,
}

impl Joints {
    pub fn append(&mut self, other: Self) -> Result<()> {
        extend(&mut self.points, other.points)?;
        extend(&mut self.edges, other.edges)
    }

    /// Joins what all processes have.
    pub fn join(mut self) -> Result<Joined> {
        let order = |p: &JointPoint| (p.id, p.thickness.to_bits());
        self.points.sort_unstable_by_key(order);
        let of_points = || self.points.chunk_by(|a, b| a.id == b.id);
        let ids = collected(of_points().map(|same| same[0].id))?;
        let number = |id: i64| ids.binary_search(&id).map_err(|_| Error::Pieces);
        let mut joined = Joined {
            points: ids.len(),
            ..Joined::default()
        };
        let mut chains = DisjointSets::new(ids.len())?;
        let mut valences = Valences::new(ids.len())?;
        for (p, same) in of_points().enumerate() {
            for own in same {
                valences.edges[p] += own.edges;
                if let Some(chain) = own.chain {
                    valences.on_boundary[p] = true;
                    chains.join(p, number(chain)?);
                }
            }
            let mut known = same.iter().map(|own| own.thickness);
            if let Some(known) = known.find(|thickness| thickness.is_finite()) {
                push(&mut joined.thickness, known)?;
            }
        }
        self.edges.sort_unstable_by_key(|edge| edge.ends);
        for same in self.edges.chunk_by(|a, b| a.ends == b.ends) {
            let [a, b] = same[0].ends;
            let (a, b) = (number(a)?, number(b)?);
            let triangles: usize = same.iter().map(|own| own.triangles).sum();
            joined.edges += 1;
            valences.add([a, b], triangles);
            if triangles == 1 {
                joined.boundary_length.add(same[0].length);
                chains.join(a, b);
            }
        }
        for p in 0..ids.len() {
            joined.interior.add_point(&valences, p);
            joined.boundary_loops += usize::from(valences.on_boundary[p] && chains.find(p) == p);
        }
        Ok(joined)
    }

    /// Appends the joints to a message for another process.
    pub fn pack(&self, message: &mut Vec<i64>) -> Result<()> {
        extend(
            message,
            [self.points.len(), self.edges.len()].map(|n| n as i64),
        )?;
        for p in &self.points {
            let chain = [p.chain.is_some().into(), p.chain.unwrap_or(0)];
            extend(
                message,
                [p.id, p.thickness.to_bits().into(), p.edges.into()],
            )?;
            extend(message, chain)?;
        }
        for edge in &self.edges {
            extend(message, edge.ends)?;
            extend(
                message,
                [edge.triangles as i64, edge.length.to_bits() as i64],
            )?;
        }
        Ok(())
    }

    /// Takes joints from the beginning of a message.
    pub fn unpack(message: &mut &[i64]) -> Result<Self> {
        let mut joints = Self::default();
        let [points, edges] = taken(message)?;
        for _ in 0..points {
            let [id, thickness, edges, has_chain, chain] = taken(message)?;
            let point = JointPoint {
                id,
                thickness: f32::from_bits(thickness as u32),
                edges: edges as u32,
                chain: (has_chain != 0).then_some(chain),
            };
            push(&mut joints.points, point)?;
        }
        for _ in 0..edges {
            let [a, b, triangles, length] = taken(message)?;
            let edge = JointEdge {
                ends: [a, b],
                triangles: triangles as usize,
                length: f64::from_bits(length as u64),
            };
            push(&mut joints.edges, edge)?;
        }
        Ok(joints)
    }
}
