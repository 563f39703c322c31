//! Panics on demand, for the tests of what a panic in any stage does to the callers of the library.
//!
//! Only there with the feature `inject-panics`, which nothing but those tests asks for. A place is a
//! pass of a stage; a visit is an item of its work, whichever thread does it. The state is that of
//! the whole process: one test at a time.

use std::collections::BTreeMap;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// The name of a stage, as observers are told it, and a pass of it, counted from 0.
pub type Place = (&'static str, usize);

struct State {
    visits: BTreeMap<Place, usize>,
    armed: Option<(Place, usize)>,
}

static STATE: Mutex<State> = Mutex::new(State {
    visits: BTreeMap::new(),
    armed: None,
});

fn state() -> MutexGuard<'static, State> {
    STATE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Lets the visit with this number, counted from 0, panic; `None`: no panic. The count starts anew.
pub fn arm(visit: Option<(Place, usize)>) {
    let mut state = state();
    state.visits.clear();
    state.armed = visit;
}

/// How often each place has been visited since [`arm`].
pub fn visits() -> BTreeMap<Place, usize> {
    state().visits.clone()
}

/// A visit, which panics where that was asked for.
pub(crate) fn visit(place: Place) {
    let mut state = state();
    let count = state.visits.entry(place).or_default();
    let visit = *count;
    *count += 1;
    let is_due = state.armed == Some((place, visit));
    drop(state);
    assert!(!is_due, "injected into {} ({})", place.0, place.1);
}
