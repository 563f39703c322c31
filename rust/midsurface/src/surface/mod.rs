//! A surface under work: triangles that are a 2-manifold with boundary, and how to go about on it.
//!
//! | what | file |
//! | --- | --- |
//! | the surface; any triangles → a 2-manifold, wound the same way | `manifold.rs` |
//! | half-edges, and the triangles round a point | `halfedge.rs` |
//! | along its boundary; normals of its points | `boundary.rs`, `normals.rs` |
//! | a few points and those around them | `region.rs` |
//! | which triangles are near, which touch | `cells.rs`, `touching.rs` |

pub(crate) mod boundary;
pub(crate) mod cells;
pub(crate) mod halfedge;
pub(crate) mod manifold;
pub(crate) mod normals;
pub(crate) mod region;
pub(crate) mod touching;
