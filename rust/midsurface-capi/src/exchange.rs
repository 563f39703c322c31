//! How processes that work on one volume reach each other: the caller's functions.

use std::ffi::{c_char, c_void};

use midsurface::Exchange;

use crate::arguments::{text, value};
use crate::error::{guarded, midsurface_error, midsurface_status};

/// How processes that work on one volume reach each other, for example by MPI.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct midsurface_exchange {
    /// Number of processes, at least 1.
    pub processes: usize,
    /// Number of this process, from 0.
    pub process: usize,
    /// Sends length numbers to the process `to`, another one than this; may wait until they are
    /// received. False: that process cannot be reached any more. Called on the calling thread only,
    /// with user. It must return normally: no C++ exception, no longjmp.
    pub send: Option<
        unsafe extern "C" fn(
            user: *mut c_void,
            to: usize,
            numbers: *const i64,
            length: usize,
        ) -> bool,
    >,
    /// Waits for length numbers, as many as the process `from` sends, and puts them into numbers;
    /// else as send.
    pub receive: Option<
        unsafe extern "C" fn(
            user: *mut c_void,
            from: usize,
            numbers: *mut i64,
            length: usize,
        ) -> bool,
    >,
    /// Passed on to both, never looked at. May be NULL.
    pub user: *mut c_void,
}

type Send = unsafe extern "C" fn(*mut c_void, usize, *const i64, usize) -> bool;
type Receive = unsafe extern "C" fn(*mut c_void, usize, *mut i64, usize) -> bool;

/// The caller's functions.
pub(crate) struct Team {
    processes: usize,
    process: usize,
    send: Send,
    receive: Receive,
    user: *mut c_void,
}

impl Exchange for Team {
    fn processes(&self) -> usize {
        self.processes
    }

    fn process(&self) -> usize {
        self.process
    }

    fn send(&mut self, to: usize, numbers: &[i64]) -> bool {
        // SAFETY: the caller's function, with the caller's argument and a readable array.
        unsafe { (self.send)(self.user, to, numbers.as_ptr(), numbers.len()) }
    }

    fn receive(&mut self, from: usize, numbers: &mut [i64]) -> bool {
        // SAFETY: the caller's function, with the caller's argument and a writable array.
        unsafe { (self.receive)(self.user, from, numbers.as_mut_ptr(), numbers.len()) }
    }
}

/// The core's exchange.
///
/// # Safety
/// `exchange` is null or as the header describes.
pub(crate) unsafe fn read(exchange: *const midsurface_exchange) -> Result<Team, midsurface_error> {
    // SAFETY: the same contract.
    let exchange = unsafe { value(exchange, "exchange") }?;
    if exchange.process >= exchange.processes {
        return Err(midsurface_error::invalid(format!(
            "`exchange.process` is {}, but `exchange.processes` is {}",
            exchange.process, exchange.processes
        )));
    }
    let missing = |name: &str| midsurface_error::invalid(format!("`exchange.{name}` is NULL"));
    Ok(Team {
        processes: exchange.processes,
        process: exchange.process,
        send: exchange.send.ok_or_else(|| missing("send"))?,
        receive: exchange.receive.ok_or_else(|| missing("receive"))?,
        user: exchange.user,
    })
}

/// Tells the other processes that this one cannot call the function that they call with such an
/// exchange, and why: theirs then fails with that message, and does not wait for ever.
///
/// exchange: how this process reaches the others.
/// message: what is amiss, UTF-8.
/// error: where an error goes; may be NULL.
#[no_mangle]
pub unsafe extern "C" fn midsurface_abandon(
    exchange: *const midsurface_exchange,
    message: *const c_char,
    error: *mut *mut midsurface_error,
) -> midsurface_status {
    // SAFETY: the pointers are as the header describes.
    unsafe {
        guarded(error, || {
            let mut team = read(exchange)?;
            let message = text(message, "message");
            midsurface::abandon(&mut team, message.as_deref().unwrap_or_default());
            message.map(drop)
        })
    }
}
