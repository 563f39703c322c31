//! What is known voxel by voxel, held where a label is: sparse fields, and rays through the label.
//!
//! | what | file |
//! | --- | --- |
//! | bricks of 8³ voxels round the labelled ones, and one with its neighbours | `bricks.rs`, `block.rs` |
//! | how far each voxel is from the outside; the label as bits | `distance.rs`, `mask.rs` |
//! | filters along one axis after the other, brick by brick or slab by slab | `separable.rs`, `slabs.rs` |
//! | values between voxels | `interpolation.rs` |
//! | both faces of the label as seen from a point | `label.rs`, `ray.rs`, `thickness.rs` |
//! | arithmetic for many voxels at once | `vectors.rs`, `eigen.rs` |

pub(crate) mod block;
pub(crate) mod bricks;
pub(crate) mod distance;
pub(crate) mod eigen;
pub(crate) mod interpolation;
pub(crate) mod label;
pub(crate) mod mask;
pub(crate) mod ray;
pub(crate) mod separable;
pub(crate) mod slabs;
pub(crate) mod thickness;
pub(crate) mod vectors;
