//! Distance → sheets: the normal, and the offset along it to the middle, for every voxel near one.
//!
//! | step | file |
//! | --- | --- |
//! | how thick the label is here | `scale.rs` |
//! | the mask smoothed as wide as it is thick | `profile.rs` |
//! | the sheets at its crest, but where a border of the volume cuts the profile, with normals that do not lag near rims | `crest.rs`, `border.rs`, `lag.rs` |
//! | the same from one face, where a border of the volume cuts the other one off | `one_face.rs` |
//! | how sheets bend, and on to beyond their rims | `bending.rs`, `extension.rs` |
//! | neighbours agree | `settle.rs` |
//!
//! A sheet as all of them hold it, and as the polyline zipper finds it: `sheet.rs`.

pub(crate) mod bending;
mod border;
pub(crate) mod crest;
pub(crate) mod extension;
mod lag;
pub(crate) mod one_face;
pub(crate) mod profile;
pub(crate) mod scale;
pub(crate) mod settle;
pub(crate) mod sheet;
