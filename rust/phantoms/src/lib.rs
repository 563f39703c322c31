//! Label volumes whose mid-surface is known exactly, and a judge that compares meshes with it.
//!
//! A [`Phantom`] is made from [`Slab`]s: a [`Shape`] with a closed-form closest point, a
//! thickness and a label. [`judge`] measures a mesh against it, trusting nothing that the mesh's
//! maker says about it. [`mitochondrion`] makes a label volume to look at.
#![forbid(unsafe_code)]

mod accuracy;
mod catalogue;
mod dice;
mod gyroid;
mod image_file;
mod intersections;
mod judge;
mod junction;
mod mask_fit;
mod mesh_file;
mod mitochondrion;
mod phantom;
mod profile;
mod shape;
mod topology;
mod trials;
mod triangle_shape;
mod triangle_tree;
mod upright;
mod vector;

pub use accuracy::{Accuracy, Coverage, INSIDE};
pub use catalogue::*;
pub use dice::Dice;
pub use image_file::{write_mrc, write_vti};
pub use intersections::self_intersections;
pub use judge::{judge, Report};
pub use mask_fit::{mask_fit, MaskFit};
pub use mesh_file::write_ply;
pub use mitochondrion::{mitochondrion, INNER, OUTER};
pub use phantom::{flip_boundary, Frame, Junction, Neighbours, Phantom, Slab, Thickness, Topology};
pub use profile::{Profile, Vec2};
pub use shape::{Closest, Hole, Rim, Shape};
pub use topology::{closed_inward, connectivity, Connectivity};
pub use trials::{trials, Grades, Limits, Trial};
pub use triangle_shape::{shapes, Shapes};
pub use triangle_tree::distance_to_triangle;
pub use upright::{leaning_sheet, upright_tube};
pub use vector::{leaning, Vec3};
