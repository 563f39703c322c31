//! From raw pointers to checked values. An error names the argument as the header does.

use std::ffi::{c_char, CStr};
use std::ptr;

use midsurface::Error;

use crate::error::midsurface_error;

fn check<T>(pointer: *const T, name: &str) -> Result<(), midsurface_error> {
    if pointer.is_null() {
        return Err(midsurface_error::invalid(format!("`{name}` is NULL")));
    }
    if !pointer.is_aligned() {
        return Err(midsurface_error::invalid(format!(
            "`{name}` is not aligned: its address must be a multiple of {} bytes",
            align_of::<T>()
        )));
    }
    Ok(())
}

/// Copies a struct of the caller's, so that a callback that changes it does no harm.
///
/// # Safety
/// `pointer` is null or points to a `T`.
pub(crate) unsafe fn value<T: Copy>(pointer: *const T, name: &str) -> Result<T, midsurface_error> {
    check(pointer, name)?;
    // SAFETY: checked, and a T by this function's contract.
    Ok(unsafe { pointer.read() })
}

/// Borrows the object behind a handle.
///
/// # Safety
/// `pointer` is null or a live handle, which outlives `'a`.
pub(crate) unsafe fn object<'a, T>(
    pointer: *const T,
    name: &str,
) -> Result<&'a T, midsurface_error> {
    check(pointer, name)?;
    // SAFETY: checked, and a live object by this function's contract.
    Ok(unsafe { &*pointer })
}

/// Borrows an array. An empty one may be null.
///
/// # Safety
/// `pointer` is null or points to `length` values, unchanged during `'a`.
pub(crate) unsafe fn slice<'a, T>(
    pointer: *const T,
    length: usize,
    name: &str,
) -> Result<&'a [T], midsurface_error> {
    if length == 0 {
        return Ok(&[]);
    }
    check_array(pointer, length, name)?;
    // SAFETY: not null, aligned, no longer than an object may be, and valid by contract.
    Ok(unsafe { std::slice::from_raw_parts(pointer, length) })
}

/// Copies a C string; what is not UTF-8 is replaced.
///
/// # Safety
/// `pointer` is null or points to a string that ends with a NUL.
pub(crate) unsafe fn text(pointer: *const c_char, name: &str) -> Result<String, midsurface_error> {
    check(pointer, name)?;
    // SAFETY: not null, and a string by this function's contract.
    let text = unsafe { CStr::from_ptr(pointer) };
    Ok(text.to_string_lossy().into_owned())
}

/// Borrows an array that may be left out.
///
/// # Safety
/// As for [`slice`].
pub(crate) unsafe fn optional_slice<'a, T>(
    pointer: *const T,
    length: usize,
    name: &str,
) -> Result<Option<&'a [T]>, midsurface_error> {
    if pointer.is_null() {
        return Ok(None);
    }
    // SAFETY: the same contract.
    unsafe { slice(pointer, length, name) }.map(Some)
}

/// Borrows an array of the caller's for writing, cleared: it may have been uninitialised.
///
/// # Safety
/// `pointer` is null or points to room for `length` floats that nobody else uses during `'a`.
pub(crate) unsafe fn cleared<'a>(
    pointer: *mut f32,
    length: usize,
    name: &str,
) -> Result<&'a mut [f32], midsurface_error> {
    if length == 0 {
        return Ok(&mut []);
    }
    check_array(pointer, length, name)?;
    // SAFETY: as in `slice`; all bits zero is a float.
    Ok(unsafe {
        pointer.write_bytes(0, length);
        std::slice::from_raw_parts_mut(pointer, length)
    })
}

/// Checks a pointer to `length` values, `length` > 0, without looking at any.
pub(crate) fn check_array<T>(
    pointer: *const T,
    length: usize,
    name: &str,
) -> Result<(), midsurface_error> {
    check(pointer, name)?;
    length
        .checked_mul(size_of::<T>())
        .filter(|&bytes| bytes <= isize::MAX as usize)
        .filter(|&bytes| pointer.addr().checked_add(bytes).is_some())
        .map(|_| ())
        .ok_or_else(|| {
            midsurface_error::invalid(format!(
                "`{name}` is said to hold {length} values, more than memory can"
            ))
        })
}

/// Where a result goes. It holds "no result" until one is set, so that a failure leaves that.
pub(crate) struct Output<T>(*mut T);

impl<T> Output<T> {
    /// # Safety
    /// `pointer` is null or may be written while the output lives.
    pub(crate) unsafe fn new(
        pointer: *mut T,
        empty: T,
        name: &str,
    ) -> Result<Self, midsurface_error> {
        check(pointer, name)?;
        // SAFETY: checked, and writable by this function's contract.
        unsafe { pointer.write(empty) };
        Ok(Self(pointer))
    }

    pub(crate) fn set(self, value: T) {
        // SAFETY: as in `new`.
        unsafe { self.0.write(value) };
    }
}

impl<T> Output<*mut T> {
    /// # Safety
    /// As for [`Output::new`].
    pub(crate) unsafe fn handle(pointer: *mut *mut T) -> Result<Self, midsurface_error> {
        // SAFETY: the same contract.
        unsafe { Self::new(pointer, ptr::null_mut(), "out") }
    }

    /// Hands the object over to the caller.
    pub(crate) fn set_object(self, object: T) {
        self.set(Box::into_raw(Box::new(object)));
    }
}

/// Takes an object back from the caller and drops it.
///
/// # Safety
/// `pointer` is null or was handed over by [`Output::set_object`], and is not used again.
pub(crate) unsafe fn free<T>(pointer: *mut T) {
    if !pointer.is_null() {
        // SAFETY: the box that was handed over.
        drop(unsafe { Box::from_raw(pointer) });
    }
}

/// Collects values into a vector, or fails where memory is refused.
pub(crate) fn collected<T>(
    length: usize,
    values: impl Iterator<Item = T>,
) -> Result<Vec<T>, midsurface_error> {
    let mut collection = Vec::new();
    collection
        .try_reserve_exact(length)
        .map_err(|_| Error::OutOfMemory(length.saturating_mul(size_of::<T>())))?;
    collection.extend(values);
    Ok(collection)
}

/// The address of an array for C: null where it is empty.
pub(crate) fn address<T>(values: &[T]) -> *const T {
    if values.is_empty() {
        ptr::null()
    } else {
        values.as_ptr()
    }
}
