//! Links the library that CMake has built, whose folder FILTER_BRIDGE_FOLDER names.

fn main() {
    println!("cargo:rerun-if-env-changed=FILTER_BRIDGE_FOLDER");
    println!("cargo:rerun-if-changed=FilterBridge.h");
    println!("cargo:rerun-if-changed=src/lib.rs");
    let folder = std::env::var("FILTER_BRIDGE_FOLDER")
        .expect("FILTER_BRIDGE_FOLDER: the folder of libfilter_bridge.so, which ctest names");
    cxx_build::bridge("src/lib.rs")
        .include(".")
        .std("c++17")
        .flag("-Wall")
        .flag("-Wextra")
        .compile("filter_bridge_calls");
    println!("cargo:rustc-link-search=native={folder}");
    println!("cargo:rustc-link-lib=dylib=filter_bridge");
    println!("cargo:rustc-link-arg=-Wl,-rpath,{folder}");
}
