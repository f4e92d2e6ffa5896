//! The command line of a tool: its own options and what every tool offers beside them.

use std::io::Write;
use std::path::PathBuf;

use bipenalty::scene::BUILT_IN;
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
    let takes_scenes = command.get_positionals().any(|arg| arg.get_id() == "scenes");
    let mut script = Vec::new();
    generate(shell, &mut command, name, &mut script);
    let script = String::from_utf8_lossy(&script).into_owned();
    let script = if takes_scenes { with_scenes(shell, script, name) } else { script };
    // A reader that stops early is no error.
    let _ = std::io::stdout().lock().write_all(script.as_bytes());
}

/// The script that offers built-in scenes, folders and scene files where a scene stands; for the other shells, names of files.
fn with_scenes(shell: Shell, script: String, name: &str) -> String {
    let scenes = BUILT_IN.map(|(name, _)| name).join(" ");
    match shell {
        Shell::Bash => {
            // The generator chooses the name of its function.
            let inner = script.split("complete -F ").nth(1).and_then(|rest| rest.split(' ').next());
            let Some(inner) = inner.map(str::to_owned) else { return script };
            let (function, old) = (format!("{inner}_or_scene"), format!("-F {inner} "));
            let script = script.replace(&old, &format!("-F {function} "));
            // An option without choices of its own leaves none: there, and after it, files are offered as usual.
            let wrapper = format!(
                "{function}() {{\n    local cur=${{COMP_WORDS[COMP_CWORD]}} prev=${{COMP_WORDS[COMP_CWORD-1]}}\n    {inner} \"$@\"\n    \
                 if [[ $cur != -* && $prev != -* ]]; then\n        COMPREPLY=($(compgen -W \"{scenes}\" -- \"$cur\") \
                 $(compgen -f -X '!*.toml' -- \"$cur\") $(compgen -d -S / -- \"$cur\"))\n    fi\n}}\n"
            );
            wrapper + &script
        }
        Shell::Zsh => script
            .lines()
            .map(|line| match line.trim_start().starts_with("'*::scenes --") {
                true => line.replace(
                    ":_files'",
                    &format!(":{{_alternative \"scenes:built-in scene:({scenes})\" \"files:scene file:_files -g \\\"*.toml\\\"\"}}'"),
                ),
                false => line.to_owned(),
            })
            .map(|line| line + "\n")
            .collect(),
        Shell::Fish => {
            script + &format!("complete -c {name} -a \"{scenes}\" -d 'Built-in scene'\ncomplete -c {name} -k -a \"(__fish_complete_suffix .toml)\"\n")
        }
        _ => script,
    }
}
