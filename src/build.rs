//! With the feature `lapack`, links the system's OpenBLAS, which brings LAPACK.

fn main() {
    println!("cargo:rerun-if-changed=src/build.rs");
    if std::env::var_os("CARGO_FEATURE_LAPACK").is_some() {
        println!("cargo:rustc-link-lib=dylib=openblas");
    }
}
