//! The options of a run, and the callbacks as an observer of the core's.

use std::ffi::{c_char, c_void};
use std::ptr;

use midsurface::{Method, Observer, Options};

use crate::arguments::{optional_slice, value};
use crate::error::{c_string, guarded_value, midsurface_error};

/// How the mid-surface is found: values for the field `method` of midsurface_options.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum midsurface_method {
    /// A line in every slice along z, the lines of neighbouring slices joined by triangles.
    PolylineZipper = 0,
    /// A surface midway between both faces of the membrane, in whichever direction it lies.
    RidgeSurface,
}

/// What a run may be told. Start from midsurface_options_default, so that fields that are added
/// later have their defaults.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct midsurface_options {
    /// A midsurface_method; any other value is refused. Default: the ridge surface.
    pub method: u32,
    /// Number of worker threads; 0, the default: one a core. The result does not depend on it.
    pub threads: u32,
    /// The mesh's edge length to aim at, in the unit of the spacing: finite, not negative. 0, the
    /// default: the square root of 2 times the finest spacing.
    pub edge_length: f64,
    /// The labels to extract. NULL, the default: all. Not NULL with label_count 0: none.
    pub labels: *const i64,
    /// Number of values in labels; 0 where labels is NULL.
    pub label_count: usize,
    /// Called again and again during a run, on the calling thread only, with user, the fraction
    /// done (0 to 1) and the name of the stage (valid during the call). Returning false cancels
    /// the run, which then fails with MIDSURFACE_STATUS_CANCELLED. It must return normally: no
    /// C++ exception, no longjmp. May be NULL, the default.
    pub progress: Option<
        unsafe extern "C" fn(user: *mut c_void, fraction: f64, stage: *const c_char) -> bool,
    >,
    /// Called where the user should know something although the run goes on, on the calling
    /// thread only, with user and a message (valid during the call). It must return normally, as
    /// progress. May be NULL, the default.
    pub warning: Option<unsafe extern "C" fn(user: *mut c_void, message: *const c_char)>,
    /// Passed on to both callbacks, never looked at. May be NULL, the default.
    pub user: *mut c_void,
}

/// The default options: ridge surface, all cores, all labels, no callbacks.
#[no_mangle]
pub extern "C" fn midsurface_options_default() -> midsurface_options {
    let default = midsurface_options {
        method: midsurface_method::RidgeSurface as u32,
        threads: 0,
        edge_length: 0.0,
        labels: ptr::null(),
        label_count: 0,
        progress: None,
        warning: None,
        user: ptr::null_mut(),
    };
    guarded_value(default, || default)
}

/// The caller's callbacks.
pub(crate) struct Callbacks(midsurface_options);

impl Observer for Callbacks {
    fn progress(&mut self, fraction: f64, stage: &str) -> bool {
        self.0.progress.is_none_or(|progress| {
            // SAFETY: the caller's function, with the caller's argument.
            unsafe { progress(self.0.user, fraction, c_string(stage).as_ptr()) }
        })
    }

    fn warning(&mut self, message: &str) {
        if let Some(warning) = self.0.warning {
            // SAFETY: the caller's function, with the caller's argument.
            unsafe { warning(self.0.user, c_string(message).as_ptr()) }
        }
    }
}

/// The core's options and observer.
///
/// # Safety
/// `options` is null or as the header describes.
pub(crate) unsafe fn read(
    options: *const midsurface_options,
) -> Result<(Options, Callbacks), midsurface_error> {
    // SAFETY: the same contract.
    let options = unsafe { value(options, "options") }?;
    if options.labels.is_null() && options.label_count > 0 {
        return Err(midsurface_error::invalid(format!(
            "`options.labels` is NULL, but `options.label_count` is {}",
            options.label_count
        )));
    }
    // SAFETY: as the header describes.
    let labels = unsafe { optional_slice(options.labels, options.label_count, "options.labels") }?;
    let core = Options {
        method: method(options.method)?,
        labels: labels.map(<[i64]>::to_vec),
        threads: options.threads as usize,
        edge_length: options.edge_length,
    };
    Ok((core, Callbacks(options)))
}

fn method(number: u32) -> Result<Method, midsurface_error> {
    const POLYLINE_ZIPPER: u32 = midsurface_method::PolylineZipper as u32;
    const RIDGE_SURFACE: u32 = midsurface_method::RidgeSurface as u32;
    match number {
        POLYLINE_ZIPPER => Ok(Method::PolylineZipper),
        RIDGE_SURFACE => Ok(Method::RidgeSurface),
        _ => Err(midsurface_error::invalid(format!(
            "`options.method` is {number}, which is no midsurface_method"
        ))),
    }
}
