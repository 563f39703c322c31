//! The labels of a volume.

use crate::arguments::address;
use crate::error::{midsurface_error, midsurface_status};
use crate::handles::{look, make_of_volume, release};
use crate::options::midsurface_options;
use crate::volume::midsurface_volume;

/// The labels found in a volume. Freed with midsurface_label_list_free.
#[derive(Debug)]
pub struct midsurface_label_list(Vec<i64>);

/// Finds the distinct labels of a volume, ascending, background (0) left out: one pass over the
/// scalars. A volume without labels gives an empty list.
///
/// volume, options: as described there; options.labels is not looked at.
/// out: where the new list goes.
/// error: where an error goes; may be NULL.
#[no_mangle]
pub unsafe extern "C" fn midsurface_find_labels(
    volume: *const midsurface_volume,
    options: *const midsurface_options,
    out: *mut *mut midsurface_label_list,
    error: *mut *mut midsurface_error,
) -> midsurface_status {
    // SAFETY: the pointers are as the header describes.
    unsafe {
        make_of_volume(volume, options, out, error, |volume, options, callbacks| {
            let labels = midsurface::find_labels(volume, options, callbacks)?;
            Ok(midsurface_label_list(labels))
        })
    }
}

/// Number of labels in a list; 0 for NULL.
#[no_mangle]
pub unsafe extern "C" fn midsurface_label_list_length(list: *const midsurface_label_list) -> usize {
    // SAFETY: null, or a list of this library.
    unsafe { look(list, 0, |list| list.0.len()) }
}

/// The labels of a list, ascending, midsurface_label_list_length of them, valid until the list is
/// freed; NULL for an empty list and for NULL.
#[no_mangle]
pub unsafe extern "C" fn midsurface_label_list_values(
    list: *const midsurface_label_list,
) -> *const i64 {
    // SAFETY: null, or a list of this library.
    unsafe { look(list, std::ptr::null(), |list| address(&list.0)) }
}

/// Frees a list. NULL is ignored.
#[no_mangle]
pub unsafe extern "C" fn midsurface_label_list_free(list: *mut midsurface_label_list) {
    // SAFETY: null, or a list of this library that nobody uses any more.
    unsafe { release(list) };
}
