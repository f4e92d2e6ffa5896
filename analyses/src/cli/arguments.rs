//! The command line of a tool: its own options and what every tool offers beside them.

use std::io::Write;
use std::path::PathBuf;

use clap::{Arg, Command, Parser, value_parser};
use clap_complete::{Shell, generate};

/// The options that the user typed. `--help`, `--version` and `--completions SHELL` print and end the program; what is
/// refused ends it with exit status 2.
pub fn arguments<O: Parser>() -> O {
    let name = tool();
    let mut command = O::command().display_name(&name).arg(completions());
    let typed = command.get_matches_mut();
    if let Some(shell) = typed.get_one::<Shell>("completions") {
        print_completions(*shell, command, &name);
        std::process::exit(0);
    }
    O::from_arg_matches(&typed).unwrap_or_else(|error| error.exit())
}

/// The name the program was called by.
fn tool() -> String {
    let path = std::env::args_os().next().map(PathBuf::from);
    let stem = path.as_deref().and_then(|path| path.file_stem());
    stem.map_or_else(|| "bipenalty".to_owned(), |stem| stem.to_string_lossy().into_owned())
}

fn completions() -> Arg {
    Arg::new("completions")
        .long("completions")
        .value_name("SHELL")
        .value_parser(value_parser!(Shell))
        .hide_possible_values(true)
        .exclusive(true)
        .help("Print the completions for bash, zsh, fish, elvish or powershell; do nothing else")
}

fn print_completions(shell: Shell, mut command: Command, name: &str) {
    let mut script = Vec::new();
    generate(shell, &mut command, name, &mut script);
    // A reader that stops early is no error.
    let _ = std::io::stdout().lock().write_all(&script);
}
