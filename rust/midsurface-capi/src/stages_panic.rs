//! A panic in any stage, in a worker or on the calling thread, becomes an error with its message,
//! and the next run gives what the first one gave.
//!
//! `cargo test -p midsurface-capi --features inject-panics --lib stages_panic`; under
//! AddressSanitizer, as `tests/sanitizers.sh` runs it, nothing may leak either.

use std::collections::{BTreeMap, BTreeSet};
use std::ffi::{c_void, CStr};
use std::mem::MaybeUninit;
use std::{ptr, slice};

use midsurface::injected_panics::{arm, visits, Place};

use crate::error::{
    midsurface_error, midsurface_error_free, midsurface_error_message, midsurface_status,
};
use crate::exchange::midsurface_exchange;
use crate::labels::{midsurface_find_labels, midsurface_label_list_free};
use crate::mesh::{
    midsurface_extract, midsurface_extract_piece, midsurface_mesh, midsurface_mesh_free,
    midsurface_mesh_view,
};
use crate::options::{midsurface_method, midsurface_options, midsurface_options_default};
use crate::piece::midsurface_piece;
use crate::polylines::{
    midsurface_extract_polylines, midsurface_extract_polylines_piece, midsurface_polylines,
    midsurface_polylines_free, midsurface_zip, midsurface_zip_piece,
};
use crate::ridge_field::{midsurface_ridge_field, midsurface_ridge_field_piece};
use crate::volume::{midsurface_scalar_type, midsurface_volume};

const SIZE: [usize; 3] = [26, 24, 20];
const VOXELS: usize = SIZE[0] * SIZE[1] * SIZE[2];

/// A tube with a hole in its wall, which leaves the volume through both z faces, and a thin sheet
/// of another label.
fn labels() -> Vec<u8> {
    let [nx, ny, _] = SIZE;
    (0..VOXELS)
        .map(|i| {
            let [x, y, z] = [i % nx, i / nx % ny, i / (nx * ny)].map(|v| v as f64);
            let is_in_hole = (y - 11.3).hypot(z - 10.0) < 3.0 && x > 8.0;
            let from_axis = (x - 8.7).hypot(y - 11.3);
            if (from_axis - 6.0).abs() < 1.7 && !is_in_hole {
                1
            } else {
                2 * u8::from((20..23).contains(&(x as usize)))
            }
        })
        .collect()
}

fn volume(labels: &[u8]) -> midsurface_volume {
    midsurface_volume {
        scalars: labels.as_ptr().cast(),
        length: labels.len(),
        scalar_type: midsurface_scalar_type::Uint8 as u32,
        dimensions: SIZE,
        extent_start: [0; 3],
        spacing: [1.0; 3],
        origin: [0.0; 3],
        direction: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
        use_threshold: false,
        threshold: 0.0,
    }
}

/// All of a volume, on the only process.
fn piece(volume: &midsurface_volume) -> midsurface_piece {
    midsurface_piece {
        volume: *volume,
        whole_dimensions: SIZE,
        whole_extent_start: [0; 3],
    }
}

/// No other process is there to send to.
fn alone() -> midsurface_exchange {
    unsafe extern "C" fn send(_: *mut c_void, _: usize, _: *const i64, _: usize) -> bool {
        false
    }
    unsafe extern "C" fn receive(_: *mut c_void, _: usize, _: *mut i64, _: usize) -> bool {
        false
    }
    midsurface_exchange {
        processes: 1,
        process: 0,
        send: Some(send),
        receive: Some(receive),
        user: ptr::null_mut(),
    }
}

/// What a function gives: its status, its error, and its result as text; "" where it failed.
type Outcome = (midsurface_status, *mut midsurface_error, String);

/// The mesh's points as text. Frees the mesh.
fn points(mesh: *mut midsurface_mesh) -> String {
    if mesh.is_null() {
        return String::new();
    }
    let mut arrays = MaybeUninit::uninit();
    // SAFETY: a mesh that nobody else uses; the view is whole where the call succeeds.
    unsafe {
        let status = midsurface_mesh_view(mesh, arrays.as_mut_ptr(), ptr::null_mut());
        assert_eq!(status, midsurface_status::Ok);
        let arrays = arrays.assume_init();
        let points = slice::from_raw_parts(arrays.points, 3 * arrays.point_count);
        let text = format!("{points:?}");
        midsurface_mesh_free(mesh);
        text
    }
}

/// What a call that makes a mesh gives.
fn mesh_outcome(
    call: impl FnOnce(&mut *mut midsurface_mesh, &mut *mut midsurface_error) -> midsurface_status,
) -> Outcome {
    let (mut mesh, mut error) = (ptr::dangling_mut(), ptr::null_mut());
    let status = call(&mut mesh, &mut error);
    (status, error, points(mesh))
}

fn extract(volume: &midsurface_volume, options: &midsurface_options) -> Outcome {
    mesh_outcome(|mesh, error| unsafe { midsurface_extract(volume, options, mesh, error) })
}

fn zip(lines: *const midsurface_polylines, options: &midsurface_options) -> Outcome {
    mesh_outcome(|mesh, error| unsafe { midsurface_zip(lines, options, mesh, error) })
}

fn extract_piece(piece: &midsurface_piece, options: &midsurface_options) -> Outcome {
    let exchange = alone();
    mesh_outcome(|mesh, error| unsafe {
        midsurface_extract_piece(piece, &exchange, options, mesh, error)
    })
}

fn zip_piece(lines: *const midsurface_polylines, options: &midsurface_options) -> Outcome {
    let exchange = alone();
    mesh_outcome(|mesh, error| unsafe {
        midsurface_zip_piece(lines, &exchange, options, mesh, error)
    })
}

/// What a call that makes polylines gives.
fn lines_outcome(
    call: impl FnOnce(&mut *mut midsurface_polylines, &mut *mut midsurface_error) -> midsurface_status,
) -> Outcome {
    let (mut lines, mut error) = (ptr::dangling_mut(), ptr::null_mut());
    let status = call(&mut lines, &mut error);
    // SAFETY: polylines that nobody else uses, or null.
    unsafe {
        let text = lines.as_ref().map(|lines| format!("{lines:?}"));
        midsurface_polylines_free(lines);
        (status, error, text.unwrap_or_default())
    }
}

fn extract_polylines(volume: &midsurface_volume, options: &midsurface_options) -> Outcome {
    lines_outcome(|lines, error| unsafe {
        midsurface_extract_polylines(volume, options, lines, error)
    })
}

fn extract_polylines_piece(piece: &midsurface_piece, options: &midsurface_options) -> Outcome {
    let exchange = alone();
    lines_outcome(|lines, error| unsafe {
        midsurface_extract_polylines_piece(piece, &exchange, options, lines, error)
    })
}

fn find_labels(volume: &midsurface_volume, options: &midsurface_options) -> Outcome {
    let (mut list, mut error) = (ptr::dangling_mut(), ptr::null_mut());
    // SAFETY: a list that nobody else uses, or null.
    unsafe {
        let status = midsurface_find_labels(volume, options, &mut list, &mut error);
        let text = list.as_ref().map(|list| format!("{list:?}"));
        midsurface_label_list_free(list);
        (status, error, text.unwrap_or_default())
    }
}

/// What a call that writes fields gives.
fn fields_outcome(
    call: impl FnOnce([*mut f32; 2], &mut *mut midsurface_error) -> midsurface_status,
) -> Outcome {
    let mut fields = [vec![0.0f32; VOXELS], vec![0.0f32; VOXELS]];
    let mut error = ptr::null_mut();
    let status = call(fields.each_mut().map(Vec::as_mut_ptr), &mut error);
    let is_good = status == midsurface_status::Ok;
    let text = is_good.then(|| format!("{fields:?}"));
    (status, error, text.unwrap_or_default())
}

fn ridge_field(volume: &midsurface_volume, options: &midsurface_options) -> Outcome {
    fields_outcome(|[distance, ridge], error| unsafe {
        midsurface_ridge_field(volume, options, distance, ridge, VOXELS, error)
    })
}

fn ridge_field_piece(piece: &midsurface_piece, options: &midsurface_options) -> Outcome {
    let exchange = alone();
    fields_outcome(|[distance, ridge], error| unsafe {
        midsurface_ridge_field_piece(piece, &exchange, options, distance, ridge, VOXELS, error)
    })
}

/// Whether the call succeeded, its message where it did not, and its result. The error is freed.
fn outcome((status, error, result): Outcome) -> Result<String, String> {
    assert_eq!(status == midsurface_status::Ok, error.is_null());
    if error.is_null() {
        assert!(!result.is_empty());
        return Ok(result);
    }
    assert_eq!(status, midsurface_status::Panic);
    assert!(result.is_empty(), "a failed call has a result");
    // SAFETY: not null.
    unsafe {
        let message = CStr::from_ptr(midsurface_error_message(error)).to_str();
        let message = message.expect("UTF-8").to_owned();
        midsurface_error_free(error);
        Err(message)
    }
}

/// The first, the middle and the last pass of each stage, each with the number of its items.
fn chosen(visits: BTreeMap<Place, usize>) -> BTreeMap<Place, usize> {
    let all: Vec<(Place, usize)> = visits.into_iter().collect();
    let stages = all.chunk_by(|((a, _), _), ((b, _), _)| a == b);
    let three =
        stages.flat_map(|passes| [0, passes.len() / 2, passes.len() - 1].map(|i| passes[i]));
    three.collect()
}

/// Lets passes of each stage that `run` goes through panic, each amidst its items.
fn panic_in_each_stage(name: &str, stages: &[&str], run: impl Fn() -> Outcome) {
    arm(None);
    let expected = outcome(run()).expect("a run without a panic");
    let places = chosen(visits());
    let seen: BTreeSet<&str> = places.keys().map(|(stage, _)| *stage).collect();
    assert_eq!(seen, stages.iter().copied().collect(), "{name}");
    for (place, count) in places {
        arm(Some((place, count / 2)));
        let injected = format!("internal error: injected into {} ({})", place.0, place.1);
        assert_eq!(outcome(run()), Err(injected), "{name}");
        arm(None);
        assert!(outcome(run()).as_ref() == Ok(&expected), "{name} {place:?}");
    }
}

fn polylines(volume: &midsurface_volume) -> *mut midsurface_polylines {
    let options = midsurface_options_default();
    let mut lines = ptr::null_mut();
    let status =
        unsafe { midsurface_extract_polylines(volume, &options, &mut lines, ptr::null_mut()) };
    assert_eq!(status, midsurface_status::Ok);
    lines
}

const READING: &str = "Reading labels";
const FIELD: &str = "Computing the ridge field";
const TRACING: &str = "Tracing mid-polylines";
const ZIPPING: [&str; 2] = ["Zipping polylines", "Making the mesh"];
const REMESHING: [&str; 2] = ["Remeshing", "Finishing the mesh"];
const RIDGE_SURFACE: [&str; 11] = [
    READING,
    "Measuring thickness",
    "Smoothing labels",
    "Finding sheets",
    "Extending sheets",
    "Settling sheets",
    "Joining sheets",
    "Trimming at rims",
    "Moving midway",
    "Remeshing",
    "Flattening terraces",
];

#[test]
fn a_panic_in_any_stage_is_an_error_and_the_next_run_works() {
    // Some hundred and sixty panics are expected; their texts would only hide an unexpected one.
    let hook = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |info| {
        let text = info.payload().downcast_ref::<String>();
        if !text.is_some_and(|text| text.starts_with("injected into")) {
            hook(info);
        }
    }));
    let labels = labels();
    let volume = volume(&labels);
    let lines = polylines(&volume);
    let ridge_surface = midsurface_options {
        threads: 2,
        ..midsurface_options_default()
    };
    let zipper = midsurface_options {
        method: midsurface_method::PolylineZipper as u32,
        ..ridge_surface
    };
    let stages = [&[READING, FIELD, TRACING], &ZIPPING[..], &REMESHING].concat();
    panic_in_each_stage("labels", &["Finding labels"], || {
        find_labels(&volume, &zipper)
    });
    panic_in_each_stage("ridge surface", &RIDGE_SURFACE, || {
        extract(&volume, &ridge_surface)
    });
    panic_in_each_stage("zipper", &stages, || extract(&volume, &zipper));
    panic_in_each_stage("polylines", &stages[..3], || {
        extract_polylines(&volume, &zipper)
    });
    panic_in_each_stage("zip", &ZIPPING, || zip(lines, &zipper));
    panic_in_each_stage("ridge field", &stages[..2], || {
        ridge_field(&volume, &zipper)
    });
    let piece = piece(&volume);
    panic_in_each_stage("ridge surface of a piece", &RIDGE_SURFACE, || {
        extract_piece(&piece, &ridge_surface)
    });
    panic_in_each_stage("zipper on a piece", &stages, || {
        extract_piece(&piece, &zipper)
    });
    panic_in_each_stage("polylines of a piece", &stages[..3], || {
        extract_polylines_piece(&piece, &zipper)
    });
    panic_in_each_stage("zip a piece", &ZIPPING, || zip_piece(lines, &zipper));
    panic_in_each_stage("ridge field of a piece", &stages[..2], || {
        ridge_field_piece(&piece, &zipper)
    });
    unsafe { midsurface_polylines_free(lines) };
}
