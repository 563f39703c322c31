//! What functions that hand over, read and free objects have in common.

use midsurface::{abandon, Grid, Options, Volume};

use crate::arguments::{free, object, Output};
use crate::error::{guarded, guarded_value, midsurface_error, midsurface_status};
use crate::exchange::{self, midsurface_exchange, Team};
use crate::options::{self, midsurface_options, Callbacks};
use crate::piece::{self, midsurface_piece};
use crate::volume::{self, midsurface_volume};

/// The body of a function that makes an object.
///
/// # Safety
/// The pointers are null or as the header describes.
pub(crate) unsafe fn make<T>(
    out: *mut *mut T,
    error: *mut *mut midsurface_error,
    work: impl FnOnce() -> Result<T, midsurface_error>,
) -> midsurface_status {
    // SAFETY: the same contract.
    unsafe {
        guarded(error, || {
            let out = Output::handle(out)?;
            out.set_object(work()?);
            Ok(())
        })
    }
}

/// The body of a function that makes an object together with other processes: these are told where
/// there is no place for it.
///
/// # Safety
/// The pointers are null or as the header describes.
pub(crate) unsafe fn make_in_team<T>(
    exchange: *const midsurface_exchange,
    out: *mut *mut T,
    error: *mut *mut midsurface_error,
    work: impl FnOnce(&mut Team) -> Result<T, midsurface_error>,
) -> midsurface_status {
    // SAFETY: the same contract.
    unsafe {
        guarded(error, || {
            let out = Output::handle(out);
            let mut team = exchange::read(exchange)?;
            let out = out.inspect_err(|error| abandon(&mut team, &error.text()))?;
            out.set_object(work(&mut team)?);
            Ok(())
        })
    }
}

/// The body of a function that makes an object of a volume that several processes hold in pieces.
///
/// # Safety
/// The pointers are null or as the header describes.
pub(crate) unsafe fn make_of_piece<T>(
    piece: *const midsurface_piece,
    exchange: *const midsurface_exchange,
    options: *const midsurface_options,
    out: *mut *mut T,
    error: *mut *mut midsurface_error,
    work: impl FnOnce(
        (Option<&Volume>, &Grid),
        &Options,
        &mut Team,
        &mut Callbacks,
    ) -> Result<T, midsurface_error>,
) -> midsurface_status {
    // SAFETY: the same contract.
    unsafe {
        make_in_team(exchange, out, error, |team| {
            let ((piece, whole), (options, mut callbacks)) =
                told(team, || Ok((piece::read(piece)?, options::read(options)?)))?;
            let volume = piece.as_ref().map(|(volume, _)| volume);
            work((volume, &whole), &options, team, &mut callbacks)
        })
    }
}

/// What `read` makes of arguments; the other processes are told where it fails.
pub(crate) fn told<T>(
    team: &mut Team,
    read: impl FnOnce() -> Result<T, midsurface_error>,
) -> Result<T, midsurface_error> {
    read().inspect_err(|error| abandon(team, &error.text()))
}

/// The body of a function that makes an object of a volume.
///
/// # Safety
/// The pointers are null or as the header describes.
pub(crate) unsafe fn make_of_volume<T>(
    volume: *const midsurface_volume,
    options: *const midsurface_options,
    out: *mut *mut T,
    error: *mut *mut midsurface_error,
    work: impl FnOnce(&Volume, &Options, &mut Callbacks) -> Result<T, midsurface_error>,
) -> midsurface_status {
    // SAFETY: the same contract.
    unsafe {
        make(out, error, || {
            let (volume, _) = volume::read(volume)?;
            let (options, mut callbacks) = options::read(options)?;
            work(&volume, &options, &mut callbacks)
        })
    }
}

/// The body of a function that shows the arrays of the object called `name`; `empty` shows none.
///
/// # Safety
/// The pointers are null or as the header describes.
pub(crate) unsafe fn show<T, A>(
    handle: *const T,
    name: &str,
    out: *mut A,
    empty: A,
    error: *mut *mut midsurface_error,
    arrays: impl FnOnce(&T) -> A,
) -> midsurface_status {
    // SAFETY: the same contract.
    unsafe {
        guarded(error, || {
            let out = Output::new(out, empty, "out")?;
            out.set(arrays(object(handle, name)?));
            Ok(())
        })
    }
}

/// The body of a function that tells something about an object; `otherwise` for null.
///
/// # Safety
/// `handle` is null or a live object of this library.
pub(crate) unsafe fn look<T, R: Copy>(
    handle: *const T,
    otherwise: R,
    tell: impl FnOnce(&T) -> R,
) -> R {
    // SAFETY: the same contract.
    guarded_value(otherwise, || {
        unsafe { handle.as_ref() }.map_or(otherwise, tell)
    })
}

/// The body of a function that frees an object.
///
/// # Safety
/// `handle` is null or an object of this library that nobody uses any more.
pub(crate) unsafe fn release<T>(handle: *mut T) {
    // SAFETY: the same contract.
    guarded_value((), || unsafe { free(handle) });
}
