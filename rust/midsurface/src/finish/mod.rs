//! Mesh → mesh: what is left to do once the triangles are nearly equilateral.
//!
//! | step | file |
//! | --- | --- |
//! | terraces of the voxel grid are flattened, where sheets run nearly along its planes | `terraces.rs`, `lattice.rs` |
//! | what has become sharp is widened | `sharp.rs` |
//! | what crosses itself is cut open | `self_intersections.rs` |

pub(crate) mod lattice;
pub(crate) mod self_intersections;
pub(crate) mod sharp;
pub(crate) mod terraces;
