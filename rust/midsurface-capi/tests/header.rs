//! The committed header is what cbindgen makes of the sources.
//!
//! With MIDSURFACE_UPDATE_HEADER=1 in the environment it is written anew.

use std::path::Path;
use std::{env, fs};

#[test]
fn the_header_is_current() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let path = folder.join("include/midsurface.h");
    let generated = generated(folder);
    if env::var_os("MIDSURFACE_UPDATE_HEADER").is_some_and(|value| value == "1") {
        fs::write(&path, &generated).expect("header written");
    }
    let committed = fs::read_to_string(&path).expect("header");
    assert!(
        committed == generated,
        "{} is stale: run MIDSURFACE_UPDATE_HEADER=1 cargo test -p midsurface-capi --test header",
        path.display()
    );
}

/// Given one source instead of the crate, cbindgen follows its modules without asking cargo, so
/// that no registry is needed.
fn generated(folder: &Path) -> String {
    let configuration = cbindgen::Config::from_file(folder.join("cbindgen.toml"));
    let mut text = Vec::new();
    cbindgen::Builder::new()
        .with_config(configuration.expect("configuration"))
        .with_src(folder.join("src/lib.rs"))
        .generate()
        .expect("bindings")
        .write(&mut text);
    String::from_utf8(text).expect("UTF-8")
}
