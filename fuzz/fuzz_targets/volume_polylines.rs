//! See `harness/volume.c`.
#![no_main]

extern crate midsurface_capi;

extern "C" {
    fn fuzz_volume_polylines(data: *const u8, size: usize);
}

libfuzzer_sys::fuzz_target!(|data: &[u8]| unsafe {
    fuzz_volume_polylines(data.as_ptr(), data.len())
});
