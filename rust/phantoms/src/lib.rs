//! Label volumes whose mid-surface is known exactly, and a judge that compares meshes with it.
//!
//! A [`Phantom`] is made from [`Slab`]s: a [`Shape`] with a closed-form closest point, a
//! thickness and a label. [`judge`] measures a mesh against it, trusting nothing that the mesh's
//! maker says about it. [`mitochondrion`] makes a label volume to look at.
#![forbid(unsafe_code)]

mod catalogue;
mod image_file;
mod judge;
mod mitochondrion;
mod phantom;
mod shape;
mod topology;
mod vector;

pub use catalogue::*;
pub use image_file::{write_mrc, write_vti};
pub use judge::{distance_to_triangle, judge, Report};
pub use mitochondrion::{mitochondrion, INNER, OUTER};
pub use phantom::{flip_boundary, Frame, Phantom, Slab, Thickness, Topology};
pub use shape::{Closest, Hole, Rim, Shape};
pub use topology::{connectivity, Connectivity};
pub use vector::{leaning, Vec3};
