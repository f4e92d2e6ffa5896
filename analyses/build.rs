//! Hands the git revision to the records; a crate built outside a checkout says "unknown".

use std::process::Command;

/// What the programs are made of, seen from the top level.
const SOURCES: [&str; 4] = ["src", "analyses", "Cargo.toml", "Cargo.lock"];

/// The revision of the sources, asked again when a source changes and not when git writes its index: a status, or a commit
/// of something else, costs no build. What is built after a change says "-dirty" until a source changes again.
fn main() {
    for source in SOURCES {
        println!("cargo:rerun-if-changed=../{source}");
    }
    let changed = git(&[&["status", "--porcelain", "--"], &SOURCES[..]].concat());
    let dirty = if changed.is_some_and(|files| !files.is_empty()) { "-dirty" } else { "" };
    let revision = git(&["rev-parse", "--short=12", "HEAD"]).map(|hash| hash + dirty);
    println!("cargo:rustc-env=BIPENALTY_REVISION={}", revision.unwrap_or_else(|| "unknown".to_owned()));
}

/// What git prints at the top level; `None` without git or outside a checkout.
fn git(arguments: &[&str]) -> Option<String> {
    let out = Command::new("git").current_dir("..").args(arguments).output().ok();
    let out = out.filter(|out| out.status.success())?;
    Some(String::from_utf8_lossy(&out.stdout).trim().to_owned())
}
