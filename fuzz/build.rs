//! The harness is in C, as callers of the C interface are.

fn main() {
    let sources = ["bytes.c", "volume.c", "polylines.c", "triangles.c"];
    println!("cargo:rerun-if-changed=harness");
    println!("cargo:rerun-if-changed=../rust/midsurface-capi/include");
    cc::Build::new()
        .files(sources.map(|name| format!("harness/{name}")))
        .include("../rust/midsurface-capi/include")
        .std("c11")
        .warnings_into_errors(true)
        .compile("harness");
}
