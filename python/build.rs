//! macOS links a library only where it is told that symbols may come from whoever loads it.

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    if std::env::var("CARGO_CFG_TARGET_OS").is_ok_and(|os| os == "macos") {
        for word in ["-undefined", "dynamic_lookup"] {
            println!("cargo:rustc-cdylib-link-arg={word}");
        }
    }
}
