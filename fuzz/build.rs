//! The harness is in C, as callers of the C interface are.

fn main() {
    let own = ["bytes", "volume", "pieces", "polylines", "triangles"];
    let own = own.map(|name| format!("harness/{name}.c"));
    println!("cargo:rerun-if-changed=harness");
    println!("cargo:rerun-if-changed=../tests/c/two_processes.c");
    println!("cargo:rerun-if-changed=../rust/midsurface-capi/include");
    cc::Build::new()
        .files(own)
        .file("../tests/c/two_processes.c")
        .include("../tests/c")
        .include("../rust/midsurface-capi/include")
        .std("c11")
        .warnings_into_errors(true)
        .compile("harness");
}
