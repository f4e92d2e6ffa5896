//! What other programs do with the same problems: scripts that print rows, run beside the tool with a bounded time.

use std::io::{Read, Write};
use std::process::{Command, ExitCode, Stdio};
use std::time::{Duration, Instant};

use crate::error::{Error, Refusal, Result};
use precision::Measurement;

/// A Python that can import scipy.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Peers {
    python: String,
}

/// What a script has left.
#[derive(Debug, Clone, PartialEq)]
pub struct PeerRows {
    /// Its rows, those of a script that was stopped included.
    pub measurements: Vec<Measurement>,
    /// Why it did not come to its end.
    pub broken_off: Option<String>,
}

impl Peers {
    /// The interpreter that was asked for, or else `python3`, or none where the latter has no scipy.
    ///
    /// # Errors
    /// Refuses an interpreter that was asked for and cannot import scipy.
    pub fn find(asked: Option<&str>) -> Result<Option<Self>, Refusal> {
        if asked == Some("none") {
            return Ok(None);
        }
        let python = asked.unwrap_or("python3").to_owned();
        let import = Command::new(&python).args(["-c", "import scipy.sparse.linalg"]).output();
        match import.is_ok_and(|output| output.status.success()) {
            true => Ok(Some(Self { python })),
            false if asked.is_some() => {
                Err(Refusal::new("--peers", python, "a Python that can import scipy, or none"))
            }
            false => Ok(None),
        }
    }

    /// Runs `script` with `arguments` and `input` on its standard input for at most `limit`.
    ///
    /// # Errors
    /// If the interpreter cannot be started, or prints what is no row.
    pub fn run(&self, script: &str, arguments: &[&str], input: &str, limit: Duration) -> Result<PeerRows> {
        let failed = |source| Error::File { path: self.python.clone().into(), wanted: "run", source };
        let mut child = Command::new(&self.python)
            .args(["-c", script])
            .args(arguments)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .map_err(failed)?;
        if let Some(mut stdin) = child.stdin.take() {
            stdin.write_all(input.as_bytes()).map_err(failed)?;
        }
        let stdout = child.stdout.take();
        let reader = std::thread::spawn(move || {
            let mut text = String::new();
            // What cannot be read is missing from the rows, and the status tells.
            let _ = stdout.map(|mut stdout| stdout.read_to_string(&mut text));
            text
        });
        let begun = Instant::now();
        let broken_off = loop {
            match child.try_wait().map_err(failed)? {
                Some(status) if status.success() => break None,
                Some(status) => break Some(format!("ended with {status}")),
                None if begun.elapsed() > limit => {
                    child.kill().and_then(|()| child.wait().map(|_| ())).map_err(failed)?;
                    break Some(format!("stopped after {} s", limit.as_secs()));
                }
                None => std::thread::sleep(Duration::from_millis(20)),
            }
        };
        let text = reader.join().unwrap_or_default();
        Ok(PeerRows { measurements: parse(&text)?, broken_off })
    }
}

/// The rows of `text`; a last line without its end, of a script that was stopped, is none.
fn parse(text: &str) -> Result<Vec<Measurement>> {
    let whole = text.rfind('\n').map_or("", |end| &text[..=end]);
    let rows = csv::Reader::from_reader(whole.as_bytes()).into_deserialize().collect::<Result<_, _>>();
    rows.map_err(|error| Error::Record(format!("a peer printed {error}")))
}

/// OpenBLAS reads its number of threads when it is loaded: with the feature `lapack` the run is repeated with one, unless
/// the user chose. Returns the exit status of the repeated run.
pub fn restarted_with_one_blas_thread() -> Option<ExitCode> {
    const BLAS_THREADS: &str = "OPENBLAS_NUM_THREADS";
    if !cfg!(feature = "lapack") || std::env::var_os(BLAS_THREADS).is_some() {
        return None;
    }
    let program = std::env::current_exe().ok()?;
    let status =
        Command::new(program).args(std::env::args_os().skip(1)).env(BLAS_THREADS, "1").status().ok()?;
    Some(ExitCode::from(u8::try_from(status.code().unwrap_or(2)).unwrap_or(2)))
}

/// The processor and the number of cores, such as `AMD EPYC, 2 cores (linux x86_64)`.
pub fn machine() -> String {
    let cpus = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = cpus.lines().find_map(|line| line.strip_prefix("model name")?.split_once(": "));
    let model = model.map_or("unknown processor", |(_, name)| name.trim());
    let cores = std::thread::available_parallelism().map_or(1, |n| n.get());
    format!("{model}, {cores} cores ({} {})", std::env::consts::OS, std::env::consts::ARCH)
}

#[cfg(test)]
mod tests {
    use super::*;
    use precision::Status;

    const HEADER: &str = "family,problem,method,size,error,seconds,evaluations,status\n";

    #[test]
    fn rows_are_read_and_half_a_line_is_none() {
        let text = format!(
            "{HEADER}stepping,p,numpy,25,0.5,1e-3,150,done\neigenvalue,q,scipy,9,,,,failed: no\nstep"
        );
        let rows = parse(&text).unwrap();
        assert_eq!(rows.len(), 2);
        assert_eq!((rows[0].error, rows[0].evaluations), (Some(0.5), Some(150)));
        assert_eq!(rows[1].status, Status::Failed("no".to_owned()));
        assert!(parse(&format!("{HEADER}stepping,p,numpy,25,0.5,1e-3,150,splendid\n")).is_err());
        assert!(parse(&format!("{HEADER}cooking,p,numpy,25,0.5,1e-3,150,done\n")).is_err());
        assert_eq!(parse("").unwrap(), []);
    }
}
