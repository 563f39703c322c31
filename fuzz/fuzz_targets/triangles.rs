//! See `harness/triangles.c`.
#![no_main]

extern crate midsurface_capi;

extern "C" {
    fn fuzz_triangles(data: *const u8, size: usize);
}

libfuzzer_sys::fuzz_target!(|data: &[u8]| unsafe { fuzz_triangles(data.as_ptr(), data.len()) });
