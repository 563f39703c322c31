//! Mesh in pieces → the same mesh in pieces of whole components.
//!
//! Where several processes hold triangles of one component the first of them gets those of the others: what
//! they have in common is told by the numbers of the points among those of all. So a component has to fit
//! into one process as a mesh, which takes much less than it took to make.

use crate::error::{collected, extend, push, Error, Result};
use crate::exchange::Team;
use crate::grid::Vec3;
use crate::statistics::TriangleMesh;

/// Label and component; 0 where a mesh has none.
type Key = [i64; 2];

/// Numbers that a triangle is sent as: its key, and of each corner its number, place and thickness.
const TRIANGLE_LENGTH: usize = 17;

/// The mesh that a process has then.
pub(crate) struct Regrouped {
    points: Vec<Vec3>,
    triangles: Vec<[i64; 3]>,
    thickness: Option<Vec<f32>>,
    labels: Option<Vec<i64>>,
    components: Option<Vec<i64>>,
}

impl Regrouped {
    pub fn mesh(&self) -> TriangleMesh<'_> {
        TriangleMesh {
            points: &self.points,
            triangles: &self.triangles,
            thickness: self.thickness.as_deref(),
            labels: self.labels.as_deref(),
            components: self.components.as_deref(),
            point_ids: None,
        }
    }

    fn add_point(&mut self, place: Vec3, thickness: f32) -> Result<i64> {
        push(&mut self.points, place)?;
        if let Some(of_points) = &mut self.thickness {
            push(of_points, thickness)?;
        }
        Ok(self.points.len() as i64 - 1)
    }

    fn add_triangle(&mut self, corners: [i64; 3], [label, component]: Key) -> Result<()> {
        push(&mut self.triangles, corners)?;
        if let Some(labels) = &mut self.labels {
            push(labels, label)?;
        }
        if let Some(components) = &mut self.components {
            push(components, component)?;
        }
        Ok(())
    }
}

/// The own piece of a mesh whose indices are sound, with whole components; `None` where all are that
/// already, or their points have no numbers.
pub(crate) fn regrouped(mesh: &TriangleMesh, team: &mut Team) -> Result<Option<Regrouped>> {
    let homes = homes(mesh, team)?;
    if homes.is_empty() {
        return Ok(None);
    }
    let ids = mesh.point_ids.unwrap_or_default();
    let thickness = |p: usize| mesh.thickness.map_or(f32::NAN, |known| known[p]);
    let mut own = Regrouped {
        points: collected(mesh.points.iter().copied())?,
        triangles: Vec::new(),
        thickness: mesh
            .thickness
            .map(|t| collected(t.iter().copied()))
            .transpose()?,
        labels: mesh.labels.map(|_| Vec::new()),
        components: mesh.components.map(|_| Vec::new()),
    };
    let mut messages = vec![Vec::new(); team.processes()];
    for (t, corners) in mesh.triangles.iter().enumerate() {
        let key = key(mesh, t);
        let home = homes.binary_search_by_key(&key, |home| home.0).ok();
        match home.map(|at| homes[at].1) {
            Some(home) if home != team.process() => {
                extend(&mut messages[home], key)?;
                for p in corners.map(|p| p as usize) {
                    let [x, y, z] = mesh.points[p].map(|v| v.to_bits() as i64);
                    let thickness = i64::from(thickness(p).to_bits());
                    extend(&mut messages[home], [ids[p], x, y, z, thickness])?;
                }
            }
            _ => own.add_triangle(*corners, key)?,
        }
    }
    let mut known = collected(ids.iter().zip(0..).map(|(id, p)| (*id, p)))?;
    known.sort_unstable();
    for message in team.swap(messages)? {
        take(&mut own, &mut known, &message)?;
    }
    Ok(Some(own))
}

/// Takes the triangles in a message; `known` are the numbers of the points that are there.
fn take(own: &mut Regrouped, known: &mut Vec<(i64, i64)>, message: &[i64]) -> Result<()> {
    let sent = || message.chunks_exact(TRIANGLE_LENGTH);
    let corners = sent().flat_map(|triangle| triangle[2..].chunks_exact(5));
    let mut corners = collected(corners.filter(|c| number(known, c[0]).is_none()))?;
    corners.sort_unstable();
    corners.dedup_by_key(|corner| corner[0]);
    for corner in corners {
        let place = [1, 2, 3].map(|a| f64::from_bits(corner[a] as u64));
        let p = own.add_point(place, f32::from_bits(corner[4] as u32))?;
        push(known, (corner[0], p))?;
    }
    known.sort_unstable();
    for triangle in sent() {
        let corner = |k: usize| number(known, triangle[2 + 5 * k]).ok_or(Error::Pieces);
        own.add_triangle(
            [corner(0)?, corner(1)?, corner(2)?],
            [triangle[0], triangle[1]],
        )?;
    }
    Ok(())
}

fn number(known: &[(i64, i64)], id: i64) -> Option<i64> {
    let at = known.binary_search_by_key(&id, |known| known.0).ok()?;
    Some(known[at].1)
}

fn key(mesh: &TriangleMesh, t: usize) -> Key {
    [mesh.labels, mesh.components].map(|of_triangles| of_triangles.map_or(0, |of| of[t]))
}

/// The components that several processes hold, and the first of these.
fn homes(mesh: &TriangleMesh, team: &mut Team) -> Result<Vec<(Key, usize)>> {
    let all = 0..mesh.triangles.len();
    let mut own = collected(all.map(|t| key(mesh, t)))?;
    own.sort_unstable();
    own.dedup();
    let is_told = mesh.components.is_some() && mesh.point_ids.is_some();
    let mut message = collected([i64::from(is_told)])?;
    extend(&mut message, own.into_iter().flatten())?;
    let mut holders = Vec::new();
    for (process, message) in team.share(&message)?.iter().enumerate() {
        if let Some((is_told, keys)) = message.split_first() {
            let keys = keys.chunks_exact(2).map(|key| [key[0], key[1]]);
            extend(&mut holders, keys.map(|key| (key, process, *is_told == 1)))?;
        }
    }
    holders.sort_unstable();
    let mut homes = Vec::new();
    for same in holders.chunk_by(|a, b| a.0 == b.0) {
        if same.len() > 1 && same.iter().all(|holder| holder.2) {
            push(&mut homes, (same[0].0, same[0].1))?;
        }
    }
    Ok(homes)
}
