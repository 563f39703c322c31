//! The triangle mesh.

/// A triangle mesh: a 2-manifold with boundary, consistently wound in each component.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Mesh {
    /// World coordinates, x, y, z.
    pub points: Vec<[f32; 3]>,
    /// Three point indices a triangle.
    pub triangles: Vec<[u32; 3]>,
    /// Unit normal of each point.
    pub normals: Vec<[f32; 3]>,
    /// Distance between both faces of the label at each point, world units.
    pub thickness: Vec<f32>,
    /// Label of each triangle.
    pub labels: Vec<i64>,
    /// Component of each triangle: the label's 26-connected component, from 0, ordered by label,
    /// then by size, the largest first.
    pub components: Vec<u32>,
}
