//! The markup of labels: `C_{r}`, `10^{-3}`, `*β*_{s}`.
//!
//! `_{..}` sets a subscript, `^{..}` a superscript, `*..*` italics; a backslash takes the next
//! character as it is. Anything else that looks like markup is an error, so that no stray
//! underscore is ever printed.

use super::error::PlotError;

/// Height of a run of text relative to the baseline.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Level {
    Base,
    Sub,
    Super,
}

/// A run of characters set alike.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Run {
    pub(super) text: String,
    pub(super) italic: bool,
    pub(super) level: Level,
}

/// A label as the user meant it: markup characters escaped, so that it prints as it is.
pub fn literal(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for character in text.chars() {
        if matches!(character, '_' | '^' | '*' | '\\' | '{' | '}') {
            escaped.push('\\');
        }
        escaped.push(character);
    }
    escaped
}

/// Splits a label into runs.
pub(super) fn parse(label: &str) -> Result<Vec<Run>, PlotError> {
    let problem = |problem| PlotError::Markup { label: label.to_owned(), problem };
    let mut runs: Vec<Run> = Vec::new();
    let (mut level, mut italic) = (Level::Base, false);
    let mut characters = label.chars();
    while let Some(character) = characters.next() {
        match character {
            '_' | '^' => {
                if level != Level::Base {
                    return Err(problem("scripts cannot be nested"));
                }
                if characters.next() != Some('{') {
                    return Err(problem("`_` and `^` need braces; write `\\_` for the character"));
                }
                level = if character == '_' { Level::Sub } else { Level::Super };
            }
            '}' if level != Level::Base => level = Level::Base,
            '{' | '}' => return Err(problem("a brace without `_` or `^`")),
            '*' => italic = !italic,
            '\\' => match characters.next() {
                Some(escaped) => push(&mut runs, escaped, italic, level),
                None => return Err(problem("nothing after the backslash")),
            },
            other => push(&mut runs, other, italic, level),
        }
    }
    match (level, italic) {
        (Level::Base, false) => Ok(runs),
        (Level::Base, true) => Err(problem("`*` is not closed")),
        _ => Err(problem("a brace is not closed")),
    }
}

fn push(runs: &mut Vec<Run>, character: char, italic: bool, level: Level) {
    match runs.last_mut() {
        Some(run) if run.italic == italic && run.level == level => run.text.push(character),
        _ => runs.push(Run { text: character.to_string(), italic, level }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(text: &str, italic: bool, level: Level) -> Run {
        Run { text: text.into(), italic, level }
    }

    #[test]
    fn scripts_and_italics_become_runs() {
        let runs = parse("*C*_{r} = 10^{−3}").expect("well-formed");
        let expected = [
            run("C", true, Level::Base),
            run("r", false, Level::Sub),
            run(" = 10", false, Level::Base),
            run("−3", false, Level::Super),
        ];
        assert_eq!(runs, expected);
    }

    #[test]
    fn escaped_text_prints_as_it_is() {
        let name = "my_scene^2 {*}";
        let runs = parse(&literal(name)).expect("escaped");
        assert_eq!(runs, [run(name, false, Level::Base)]);
    }

    #[test]
    fn stray_markup_is_refused() {
        for label in ["C_r", "10^3", "C_{r", "*C", "a}", "{a", "x_{a_{b}}", "x\\"] {
            assert!(parse(label).is_err(), "{label}");
        }
    }
}
