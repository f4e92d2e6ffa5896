//! Labels for TeX: Greek, sub- and superscripts in math mode, everything else as text.

use super::error::PlotError;
use super::markup::{Level, parse};

/// A label as TeX source.
pub(super) fn tex_label(label: &str) -> Result<String, PlotError> {
    let mut tex = Modes::default();
    for run in parse(label)? {
        match run.level {
            Level::Base => run.text.chars().for_each(|c| tex.character(c, run.italic)),
            Level::Sub => tex.script('_', &run.text, run.italic),
            Level::Super => tex.script('^', &run.text, run.italic),
        }
    }
    Ok(tex.finish())
}

/// TeX source that changes between text and math as its characters need.
#[derive(Default)]
struct Modes {
    source: String,
    math: bool,
}

impl Modes {
    fn enter(&mut self, math: bool) {
        if self.math != math {
            self.source.push('$');
            self.math = math;
        }
    }

    fn character(&mut self, character: char, italic: bool) {
        let symbol = math_symbol(character);
        self.enter(symbol.is_some() || (italic && character.is_alphanumeric()));
        match symbol {
            Some(symbol) => self.source.push_str(symbol),
            None => push_text(&mut self.source, character),
        }
    }

    fn script(&mut self, mark: char, text: &str, italic: bool) {
        self.enter(true);
        self.source.push(mark);
        self.source.push('{');
        let upright = !italic && text.chars().any(char::is_alphabetic);
        self.source.push_str(if upright { "\\mathrm{" } else { "{" });
        for character in text.chars() {
            match math_symbol(character) {
                Some(symbol) => self.source.push_str(symbol),
                None => push_text(&mut self.source, character),
            }
        }
        self.source.push_str("}}");
    }

    fn finish(mut self) -> String {
        self.enter(false);
        self.source
    }
}

/// The command for a character that only math mode has.
fn math_symbol(character: char) -> Option<&'static str> {
    const SYMBOLS: [(char, &str); 18] = [
        ('β', "\\beta "),
        ('γ', "\\gamma "),
        ('λ', "\\lambda "),
        ('μ', "\\mu "),
        ('ρ', "\\rho "),
        ('σ', "\\sigma "),
        ('τ', "\\tau "),
        ('θ', "\\theta "),
        ('ω', "\\omega "),
        ('Δ', "\\Delta "),
        ('∞', "\\infty "),
        ('−', "-"),
        ('±', "\\pm "),
        ('≤', "\\le "),
        ('≥', "\\ge "),
        ('×', "\\times "),
        ('·', "\\cdot "),
        ('√', "\\surd "),
    ];
    SYMBOLS.iter().find(|(known, _)| *known == character).map(|(_, symbol)| *symbol)
}

/// A character as text; what TeX would read as a command is escaped.
fn push_text(source: &mut String, character: char) {
    match character {
        '\\' => source.push_str("\\textbackslash{}"),
        '~' => source.push_str("\\textasciitilde{}"),
        '^' => source.push_str("\\textasciicircum{}"),
        '<' => source.push_str("\\textless{}"),
        '>' => source.push_str("\\textgreater{}"),
        '…' => source.push_str("\\dots{}"),
        '²' => source.push_str("\\textsuperscript{2}"),
        '#' | '$' | '%' | '&' | '_' | '{' | '}' => {
            source.push('\\');
            source.push(character);
        }
        other => source.push(other),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scripts_greek_and_special_characters_are_set_as_such() {
        let tex = |label: &str| tex_label(label).expect("valid label");
        assert_eq!(tex("stiffness penalty *β*_{s}"), "stiffness penalty $\\beta _{\\mathrm{s}}$");
        assert_eq!(tex("5·10^{−4}"), "5$\\cdot $10$^{{-4}}$");
        assert_eq!(tex("*r* = ∞"), "$r$ = $\\infty $");
        assert_eq!(tex(&super::super::literal("a_b 50% & #1")), "a\\_b 50\\% \\& \\#1");
    }
}
