//! Where records come from, without a path or a user name.

use std::path::Path;

use serde::Serialize;

/// Version, revision, platform and command of a run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Provenance {
    /// Name and version of this crate.
    pub program: String,
    /// Git revision it was built from; "unknown" outside a checkout.
    pub revision: &'static str,
    /// Operating system and processor family.
    pub platform: String,
    /// The command line; of a path only the file name, and nothing that cannot change the numbers.
    pub command: String,
}

impl Provenance {
    /// The provenance of `tool` called with `arguments`.
    pub fn new(tool: &str, arguments: impl IntoIterator<Item = String>) -> Self {
        let mut words = vec![tool.to_owned()];
        let mut skip = false;
        for argument in arguments {
            let silent = ["--out", "--threads"].iter().any(|option| argument.starts_with(option));
            if !skip && !silent {
                words.push(file_name(&argument));
            }
            skip = silent && !argument.contains('=');
        }
        Self {
            program: concat!("bipenalty ", env!("CARGO_PKG_VERSION")).to_owned(),
            revision: env!("BIPENALTY_REVISION"),
            platform: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
            command: words.join(" "),
        }
    }
}

fn file_name(argument: &str) -> String {
    let name = Path::new(argument).file_name().and_then(|name| name.to_str());
    name.unwrap_or(argument).to_owned()
}
