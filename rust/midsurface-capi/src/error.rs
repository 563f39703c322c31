//! Status codes, the error object and the panic guard.

use std::any::Any;
use std::borrow::Cow;
use std::ffi::{c_char, CString};
use std::panic::{catch_unwind, AssertUnwindSafe};
use std::ptr;

use midsurface::Error;

use crate::handles::{look, release};

/// How a call ended.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum midsurface_status {
    /// The call succeeded.
    Ok = 0,
    /// An argument or the data cannot be used; the message says which and why.
    InvalidArgument,
    /// The system refused memory.
    OutOfMemory,
    /// The progress callback asked to stop.
    Cancelled,
    /// A bug in the library; the message is the panic's.
    Panic,
}

/// Why a call failed: a status and a message. Freed with midsurface_error_free.
#[derive(Debug)]
pub struct midsurface_error {
    status: midsurface_status,
    message: CString,
}

impl midsurface_error {
    pub(crate) fn new(status: midsurface_status, message: impl Into<String>) -> Self {
        Self {
            status,
            message: c_string(&message.into()),
        }
    }

    /// The message.
    pub(crate) fn text(&self) -> Cow<'_, str> {
        self.message.to_string_lossy()
    }

    pub(crate) fn invalid(message: impl Into<String>) -> Self {
        Self::new(midsurface_status::InvalidArgument, message)
    }
}

impl From<Error> for midsurface_error {
    fn from(error: Error) -> Self {
        let status = match error {
            Error::Cancelled => midsurface_status::Cancelled,
            Error::OutOfMemory(_) => midsurface_status::OutOfMemory,
            _ => midsurface_status::InvalidArgument,
        };
        Self::new(status, error.to_string())
    }
}

/// The text as a C string. C ends a string at its first NUL, so NULs are left out.
pub(crate) fn c_string(text: &str) -> CString {
    let bytes: Vec<u8> = text.bytes().filter(|&byte| byte != 0).collect();
    CString::new(bytes).unwrap_or_default()
}

/// Runs the body of a function that can fail, and puts its error where the caller wants it.
///
/// # Safety
/// `error` is null or may be written.
pub(crate) unsafe fn guarded(
    error: *mut *mut midsurface_error,
    body: impl FnOnce() -> Result<(), midsurface_error>,
) -> midsurface_status {
    let failure = match caught(body) {
        Ok(result) => result.err(),
        Err(message) => Some(midsurface_error::new(midsurface_status::Panic, message)),
    };
    let status = failure
        .as_ref()
        .map_or(midsurface_status::Ok, |failure| failure.status);
    if !error.is_null() {
        let object = failure.map_or(ptr::null_mut(), |failure| Box::into_raw(Box::new(failure)));
        // SAFETY: not null, and writable by this function's contract.
        unsafe { error.write(object) };
    }
    status
}

/// Runs the body of a function that has no way to report an error.
pub(crate) fn guarded_value<T>(fallback: T, body: impl FnOnce() -> T) -> T {
    caught(body).unwrap_or(fallback)
}

/// The panic guard. What the body leaves half done is never looked at again.
fn caught<T>(body: impl FnOnce() -> T) -> Result<T, String> {
    catch_unwind(AssertUnwindSafe(body)).map_err(|payload| {
        let message = format!("internal error: {}", panic_message(payload.as_ref()));
        // The payload's own drop could panic once more; that panic's payload is not tried again.
        if let Err(another) = catch_unwind(AssertUnwindSafe(|| drop(payload))) {
            std::mem::forget(another);
        }
        message
    })
}

fn panic_message(payload: &(dyn Any + Send)) -> &str {
    payload
        .downcast_ref::<&str>()
        .copied()
        .or_else(|| payload.downcast_ref::<String>().map(String::as_str))
        .unwrap_or("a panic without a message")
}

/// The status of an error; MIDSURFACE_STATUS_OK for NULL.
#[no_mangle]
pub unsafe extern "C" fn midsurface_error_status(
    error: *const midsurface_error,
) -> midsurface_status {
    // SAFETY: null, or an error of this library.
    unsafe { look(error, midsurface_status::Ok, |error| error.status) }
}

/// The message of an error, UTF-8, valid until the error is freed; "" for NULL.
#[no_mangle]
pub unsafe extern "C" fn midsurface_error_message(error: *const midsurface_error) -> *const c_char {
    // SAFETY: null, or an error of this library.
    unsafe { look(error, c"".as_ptr(), |error| error.message.as_ptr()) }
}

/// Frees an error. NULL is ignored.
#[no_mangle]
pub unsafe extern "C" fn midsurface_error_free(error: *mut midsurface_error) {
    // SAFETY: null, or an error of this library that nobody uses any more.
    unsafe { release(error) };
}

#[cfg(test)]
mod tests {
    use std::ffi::CStr;

    use super::*;

    /// Runs a body as a C caller would see it: the status and the message, if any.
    fn run(
        body: impl FnOnce() -> Result<(), midsurface_error>,
    ) -> (midsurface_status, Option<String>) {
        // A stale pointer, as in uninitialised memory: it must be overwritten, never followed.
        let mut error: *mut midsurface_error = ptr::dangling_mut();
        let status = unsafe { guarded(&mut error, body) };
        let message = (!error.is_null()).then(|| unsafe {
            assert_eq!(midsurface_error_status(error), status);
            let text = CStr::from_ptr(midsurface_error_message(error));
            text.to_str().expect("UTF-8").to_owned()
        });
        unsafe { midsurface_error_free(error) };
        (status, message)
    }

    #[test]
    fn a_panic_becomes_a_status_with_its_message() {
        let (status, message) = run(|| panic!("plain"));
        assert_eq!(status, midsurface_status::Panic);
        assert_eq!(message.as_deref(), Some("internal error: plain"));

        let (_, message) = run(|| panic!("formatted {}", 7));
        assert_eq!(message.as_deref(), Some("internal error: formatted 7"));

        let (_, message) = run(|| std::panic::panic_any(3.5));
        assert_eq!(
            message.as_deref(),
            Some("internal error: a panic without a message")
        );
    }

    #[test]
    fn a_payload_that_panics_when_dropped_is_harmless() {
        struct Bomb;
        impl Drop for Bomb {
            fn drop(&mut self) {
                panic!("dropped");
            }
        }
        let (status, _) = run(|| std::panic::panic_any(Bomb));
        assert_eq!(status, midsurface_status::Panic);
    }

    #[test]
    fn a_function_without_an_error_argument_falls_back() {
        assert_eq!(guarded_value(-1, || panic!("lost")), -1);
        assert_eq!(guarded_value(-1, || 4), 4);
    }

    #[test]
    fn success_clears_the_error() {
        assert_eq!(run(|| Ok(())), (midsurface_status::Ok, None));
    }

    #[test]
    fn errors_of_the_core_keep_their_message() {
        let cases = [
            (Error::Cancelled, midsurface_status::Cancelled),
            (Error::OutOfMemory(7), midsurface_status::OutOfMemory),
            (Error::Spacing([0.0; 3]), midsurface_status::InvalidArgument),
            (
                Error::TooManyLabels { limit: 1024 },
                midsurface_status::InvalidArgument,
            ),
        ];
        for (error, status) in cases {
            let text = error.to_string();
            assert_eq!(run(|| Err(error.into())), (status, Some(text)));
        }
    }

    #[test]
    fn a_message_with_a_nul_is_not_cut() {
        let (_, message) = run(|| Err(midsurface_error::invalid("one\0two")));
        assert_eq!(message.as_deref(), Some("onetwo"));
    }

    #[test]
    fn without_a_place_for_the_error_the_status_remains() {
        let status = unsafe { guarded(ptr::null_mut(), || panic!("unheard")) };
        assert_eq!(status, midsurface_status::Panic);
    }
}
