//! See `harness/pieces.c`.
#![no_main]

extern crate midsurface_capi;

extern "C" {
    fn fuzz_volume_pieces(data: *const u8, size: usize);
}

libfuzzer_sys::fuzz_target!(|data: &[u8]| unsafe { fuzz_volume_pieces(data.as_ptr(), data.len()) });
