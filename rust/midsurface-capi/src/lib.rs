//! The C interface of midsurface, declared in `include/midsurface.h`.
//!
//! A thin layer: every function checks its arguments, borrows the caller's arrays as slices,
//! calls the core crate and hands the result over as an opaque handle. Each runs behind one panic
//! guard (`guarded` or `guarded_value` in `error.rs`), so that no panic unwinds into C. This
//! crate is the only place with `unsafe`; the doc comments of public items become the header.
#![allow(non_camel_case_types)] // the names are those of the C header
#![allow(clippy::missing_safety_doc)] // the header states what each pointer must be
#![deny(unsafe_op_in_unsafe_fn)]

mod arguments;
mod error;
mod exchange;
mod handles;
mod labels;
mod mesh;
mod options;
mod piece;
mod polyline_arrays;
mod polylines;
mod ridge_field;
#[cfg(all(test, feature = "inject-panics"))]
mod stages_panic;
mod statistics;
mod volume;

use std::ffi::c_char;

use error::guarded_value;

/// The library's version, such as "0.1.0": a string that is never freed.
#[no_mangle]
pub extern "C" fn midsurface_version() -> *const c_char {
    guarded_value(c"".as_ptr(), || {
        concat!(env!("CARGO_PKG_VERSION"), "\0").as_ptr().cast()
    })
}
