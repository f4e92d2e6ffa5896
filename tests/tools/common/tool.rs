//! Running the tool in a folder of its own.

#![allow(dead_code)]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::atomic::{AtomicUsize, Ordering};

pub const TOOL: &str = env!("CARGO_BIN_EXE_stability-map");

/// A folder for one test, empty at first, removed at the end.
pub struct Scratch(PathBuf);

impl Scratch {
    /// A folder of its own, also beside another of this name: tests run at the same time.
    pub fn new(name: &str) -> Self {
        static COUNT: AtomicUsize = AtomicUsize::new(0);
        let unique = format!("{name}-{}-{}", std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed));
        let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(unique);
        let _ = fs::remove_dir_all(&path);
        fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    pub fn path(&self) -> &Path {
        &self.0
    }

    pub fn write(&self, name: &str, text: impl AsRef<[u8]>) {
        fs::write(self.0.join(name), text).unwrap();
    }

    pub fn read(&self, name: &str) -> Vec<u8> {
        fs::read(self.0.join(name)).unwrap()
    }

    /// Every file below the folder but scenes, sorted, hidden ones included.
    pub fn files(&self) -> Vec<String> {
        let (mut found, mut folders) = (Vec::new(), vec![self.0.clone()]);
        while let Some(folder) = folders.pop() {
            for path in fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
                match path.extension() {
                    _ if path.is_dir() => folders.push(path),
                    Some(ending) if ending == "toml" => (),
                    _ => found.push(path.strip_prefix(&self.0).unwrap().to_str().unwrap().to_owned()),
                }
            }
        }
        found.sort();
        found
    }

    /// three.toml: three unequal bars, the first on a wall.
    pub fn three_bars(&self) {
        let bars = ["elements = 3", "elements = 5\nlength = 2.0", "elements = 2\ndensity = 1e12"];
        self.write("three.toml", scene("three", "left = \"wall\"", &bars));
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// A scene file. Each bar gives some keys; the others are 1.
pub fn scene(name: &str, ends: &str, bars: &[&str]) -> String {
    let mut text = format!("name = \"{name}\"\n[ends]\n{ends}\n");
    for bar in bars {
        text += &format!("[[bar]]\n{bar}\n");
        for key in ["elements", "length", "youngs_modulus", "density", "area"] {
            if !bar.lines().any(|line| line.starts_with(key)) {
                text += &format!("{key} = 1{}\n", if key == "elements" { "" } else { ".0" });
            }
        }
    }
    text
}

/// What a run left behind.
pub struct Outcome {
    pub status: i32,
    pub stdout: String,
    pub stderr: String,
}

impl Outcome {
    /// Standard output of a run that must have succeeded.
    pub fn succeeded(self) -> String {
        assert_eq!(self.status, 0, "{}", self.stderr);
        self.stdout
    }
}

/// Runs the tool in `scratch` with words split at spaces.
pub fn run(scratch: &Scratch, arguments: &str) -> Outcome {
    run_words(scratch, &arguments.split_whitespace().collect::<Vec<_>>())
}

/// Runs the tool in `scratch`; a run that is killed by a signal fails the test.
pub fn run_words(scratch: &Scratch, words: &[&str]) -> Outcome {
    run_program(TOOL, scratch, words)
}

/// Runs another program so.
pub fn run_program(program: &str, scratch: &Scratch, words: &[&str]) -> Outcome {
    let out = Command::new(program).args(words).current_dir(scratch.path()).output().unwrap();
    Outcome {
        status: out.status.code().expect("ended by a signal"),
        stdout: String::from_utf8(out.stdout).unwrap(),
        stderr: String::from_utf8(out.stderr).unwrap(),
    }
}
