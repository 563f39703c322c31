//! A finished mesh in triangles of another size.
//!
//! The zipper's triangles are as large as its lines' edges and the slices' distance make them. Where
//! other edges are asked for, `remesh` makes them, on the mesh that was there; thickness, label and
//! component of every new point and triangle are those of the place it lies at.

use crate::error::{collected, Result};
use crate::execution::Execution;
use crate::halfedge::Fans;
use crate::manifold::Surface;
use crate::mesh::{drop_degenerate, Mesh};
use crate::normals::normals;
use crate::remesh::{remesh, Origin};

impl Mesh {
    /// The mesh with edges of about `edge_length`, world units; `unit` is the finest spacing.
    pub(crate) fn with_edge_length(
        self,
        edge_length: f64,
        unit: f64,
        execution: &mut Execution,
    ) -> Result<Self> {
        let points = collected(self.points.iter().map(|p| p.map(|v| f64::from(v) / unit)))?;
        let remeshed = remesh(&points, &self.triangles, edge_length / unit, execution)?;
        drop(points);
        let in_mesh = |p: [f64; 3]| p.map(|v| (v * unit) as f32);
        let mut surface = Surface {
            source: collected(0..remeshed.points.len() as u32)?,
            points: remeshed.points,
            triangles: remeshed.triangles,
        };
        drop_degenerate(&mut surface, in_mesh, execution)?;
        let surface = surface.compact()?;
        let fans = Fans::new(&surface.triangles, surface.points.len())?;
        let normals = normals(&surface.points, &surface.triangles, &fans, execution)?;
        let origin = |point: u32| remeshed.origin[surface.source[point as usize] as usize];
        let thickness = |Origin { triangle, weights }: Origin| -> f32 {
            let corners = self.triangles[triangle as usize].iter().zip(weights);
            corners.map(|(&p, w)| w * self.thickness[p as usize]).sum()
        };
        let places = || {
            surface
                .triangles
                .iter()
                .map(|t| origin(t[0]).triangle as usize)
        };
        Ok(Self {
            labels: collected(places().map(|triangle| self.labels[triangle]))?,
            components: collected(places().map(|triangle| self.components[triangle]))?,
            thickness: collected((0..surface.points.len() as u32).map(|p| thickness(origin(p))))?,
            points: collected(surface.points.iter().map(|&p| in_mesh(p)))?,
            normals: collected(normals.iter().map(|n| n.map(|v| v as f32)))?,
            triangles: surface.triangles,
        })
    }
}
