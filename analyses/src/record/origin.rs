//! Which run has computed the rows that are drawn again: what the record beside them says.

use std::path::Path;

use serde::Serialize;
use serde_json::Value;

/// The run that has computed a file of rows, as far as it is known.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Origin {
    /// Name of the file.
    pub file: String,
    /// Program, revision, platform and command of that run; `None` where no record tells.
    #[serde(flatten)]
    pub run: Option<Run>,
    /// Why there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unknown: Option<String>,
}

/// What a record says of its run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Run {
    program: Value,
    revision: Value,
    platform: Value,
    command: Value,
}

impl Origin {
    /// The origin of the `rows` rows of `file`, by the record of the figure of the same name beside it. A record of another
    /// number of rows, or of another file, is not theirs.
    pub fn of(file: &Path, rows: usize) -> Self {
        let name = file.file_name().and_then(|name| name.to_str()).unwrap_or_default().to_owned();
        let (run, unknown) = match Self::read(file, &name, rows) {
            Ok(run) => (Some(run), None),
            Err(why) => (None, Some(why)),
        };
        Self { file: name, run, unknown }
    }

    /// The command of the run, if it is known.
    pub fn command(&self) -> Option<&str> {
        self.run.as_ref().and_then(|run| run.command.as_str())
    }

    fn read(file: &Path, name: &str, rows: usize) -> Result<Run, String> {
        let record = file.with_extension("record.json");
        let shown = record.file_name().and_then(|name| name.to_str()).unwrap_or_default().to_owned();
        let bytes = std::fs::read(&record).map_err(|_| format!("there is no {shown} beside the rows"))?;
        let record: Value = serde_json::from_slice(&bytes).map_err(|_| format!("{shown} is no record"))?;
        let of_file = |entry: &&Value| entry["file"] == name;
        let data = record["data"].as_array().and_then(|data| data.iter().find(of_file));
        match data.and_then(|data| data["rows"].as_u64()) {
            Some(known) if known == rows as u64 => (),
            Some(known) => return Err(format!("{shown} speaks of {known} rows, the file has {rows}")),
            None => return Err(format!("{shown} does not speak of this file")),
        }
        // A figure that was itself drawn again passes on what it knew.
        let earlier = record["computed"].as_array().map(|computed| computed.iter().find(of_file));
        let run = match earlier {
            None => &record,
            Some(Some(run)) if run["program"].is_string() => run,
            Some(_) => return Err(format!("{shown} does not know the run either")),
        };
        let part = |key: &str| run[key].clone();
        Ok(Run {
            program: part("program"),
            revision: part("revision"),
            platform: part("platform"),
            command: part("command"),
        })
    }
}
