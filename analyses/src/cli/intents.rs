//! The text of `--explain`: what is done with which subjects, said once for all of which the same holds.

use std::path::Path;

/// Subjects that are named before "and N others".
const NAMED: usize = 3;
/// Columns of the text.
const COLUMNS: usize = 100;
/// Before the later lines of a paragraph.
const INDENT: &str = "    ";

/// What a run intends to do with a subject: a chart, a model, a run; or with all, where there is no subject.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Intent {
    subject: Option<String>,
    method: String,
}

impl Intent {
    /// `method` for `subject`.
    pub fn of(subject: impl Into<String>, method: impl Into<String>) -> Self {
        Self { subject: Some(subject.into()), method: method.into() }
    }

    /// The same with `what` told first.
    #[must_use]
    pub fn preceded(self, what: &str) -> Self {
        Self { method: format!("{what}: {}", self.method), ..self }
    }

    /// `method` for the whole run.
    pub fn of_all(method: impl Into<String>) -> Self {
        Self { subject: None, method: method.into() }
    }
}

/// Records of an earlier run that are only drawn.
pub fn redrawn(file: &Path) -> Intent {
    Intent::of(file.display().to_string(), "drawn again; left out: every computation")
}

/// A paragraph for each method, in the order of their first subjects, in lines of at most 100 columns.
pub fn told(intents: &[Intent]) -> String {
    let mut groups: Vec<(&str, Vec<&str>)> = Vec::new();
    for Intent { subject, method } in intents {
        let place = groups.iter().position(|(known, _)| known == method);
        let place = place.unwrap_or_else(|| {
            groups.push((method, Vec::new()));
            groups.len() - 1
        });
        let subjects = &mut groups[place].1;
        subjects.extend(subject.as_deref().filter(|subject| !subjects.contains(subject)));
    }
    let mut text = String::new();
    for (method, subjects) in groups {
        let whose = match &subjects[..] {
            [] => String::new(),
            few if few.len() <= NAMED + 1 => format!("{}: ", few.join(", ")),
            many => format!("{} and {} others: ", many[..NAMED].join(", "), many.len() - NAMED),
        };
        for (number, line) in (whose + method).lines().enumerate() {
            let options = textwrap::Options::new(COLUMNS)
                .initial_indent(if number == 0 { "" } else { INDENT })
                .subsequent_indent(INDENT)
                .word_splitter(textwrap::WordSplitter::NoHyphenation);
            text += &textwrap::fill(line, options);
            text.push('\n');
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn like_lines_are_said_once_and_no_line_is_long() {
        let mut intents: Vec<Intent> =
            (1..=9).map(|run| Intent::of(format!("run-{run}"), "600 steps")).collect();
        intents.insert(1, Intent::of("other", "some words ".repeat(20)));
        intents.push(Intent::of("run-1", "600 steps"));
        intents.push(Intent::of_all("left out: eigenvectors"));
        let text = told(&intents);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[0], "run-1, run-2, run-3 and 6 others: 600 steps");
        assert!(
            lines[1].starts_with("other: some words") && lines[2].starts_with("    words some"),
            "{text}"
        );
        assert_eq!(*lines.last().unwrap(), "left out: eigenvectors");
        assert!(lines.iter().all(|line| line.len() <= COLUMNS), "{text}");
    }
}
