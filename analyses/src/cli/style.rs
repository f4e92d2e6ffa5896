//! Figures to one's taste: titles, labels, limits, levels, colours and words, by options or by a style file.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use clap::{Args, ValueEnum, ValueHint};
use serde::Deserialize;

use crate::error::{Error, Refusal, Result};
use figure::{Axis, ColourMap, Figure, Layer, Lettering, Width};

/// How figures look. An option counts before the same key of the style file.
#[derive(Debug, Clone, Default, PartialEq, Args)]
pub struct StyleOptions {
    /// Style of the figures: a TOML file with title, x_label, y_label, x_limits, y_limits, levels, colour_map, tags, text and
    /// the table words, which replaces phrases, for instance by those of another language
    #[arg(long, value_name = "FILE.toml", value_hint = ValueHint::FilePath)]
    pub style: Option<PathBuf>,
    /// Title of the figures, one a panel where it is given again; *..* italic, _{..} and ^{..} sub- and superscript
    #[arg(long, value_name = "TEXT", conflicts_with = "no_title")]
    pub title: Vec<String>,
    /// No titles: captions carry them
    #[arg(long)]
    pub no_title: bool,
    /// Label of the horizontal axes
    #[arg(long, value_name = "TEXT")]
    pub x_label: Option<String>,
    /// Label of the vertical axes
    #[arg(long, value_name = "TEXT")]
    pub y_label: Option<String>,
    /// Ends of the horizontal axes
    #[arg(long, value_name = "LOW:HIGH", allow_hyphen_values = true)]
    pub x_limits: Option<Limits>,
    /// Ends of the vertical axes
    #[arg(long, value_name = "LOW:HIGH", allow_hyphen_values = true)]
    pub y_limits: Option<Limits>,
    /// Contour lines of a map, for instance 0.25,0.5,0.75
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    pub levels: Vec<f64>,
    /// Colours of maps
    #[arg(long, value_name = "NAME")]
    pub colour_map: Option<ColourMapOption>,
    /// Tag panels (a), (b), ...
    #[arg(long)]
    pub tags: bool,
    /// Letters of an SVG: paths, which look the same everywhere, or text, to be edited
    #[arg(long, value_name = "AS")]
    pub text: Option<TextOption>,
    /// One chart for all panels of a figure; with several scenes or records one figure for all of them (stability-map)
    #[arg(long)]
    pub overlay: bool,
}

/// Both ends of an axis.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(try_from = "[f64; 2]")]
pub struct Limits(f64, f64);

impl TryFrom<[f64; 2]> for Limits {
    type Error = Refusal;

    fn try_from([low, high]: [f64; 2]) -> Result<Self, Refusal> {
        if low < high && low.is_finite() && high.is_finite() {
            return Ok(Self(low, high));
        }
        Err(Refusal::new("limits", format!("{low}:{high}"), "two finite numbers, the smaller one first"))
    }
}

impl FromStr for Limits {
    type Err = Refusal;

    fn from_str(text: &str) -> Result<Self, Refusal> {
        let ends = text.split_once(':').and_then(|(low, high)| Some([low.parse().ok()?, high.parse().ok()?]));
        let refused = || Refusal::new("limits", format!("{text:?}"), "LOW:HIGH, such as 0:10");
        ends.ok_or_else(refused)?.try_into()
    }
}

/// A colour map as typed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ColourMapOption {
    /// Dark blue over green to yellow
    Viridis,
    /// Dark blue to yellow, for colour-blind readers
    Cividis,
    /// Dark blue over green to pink
    Batlow,
    /// Black to white
    Grey,
}

impl From<ColourMapOption> for ColourMap {
    fn from(option: ColourMapOption) -> Self {
        match option {
            ColourMapOption::Viridis => Self::Viridis,
            ColourMapOption::Cividis => Self::Cividis,
            ColourMapOption::Batlow => Self::Batlow,
            ColourMapOption::Grey => Self::Grey,
        }
    }
}

/// The letters of an SVG as typed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum TextOption {
    /// Outlines of the letters
    Paths,
    /// Letters
    Text,
}

/// One title for all panels, one for each, or none.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(untagged)]
enum Titles {
    Shown(bool),
    One(String),
    Each(Vec<String>),
}

/// The settings of options and style file together.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Style {
    title: Option<Titles>,
    x_label: Option<String>,
    y_label: Option<String>,
    x_limits: Option<Limits>,
    y_limits: Option<Limits>,
    levels: Option<Levels>,
    colour_map: Option<ColourMapOption>,
    #[serde(default)]
    tags: bool,
    text: Option<TextOption>,
    #[serde(default)]
    overlay: bool,
    /// Phrases of titles, labels and legends, and what stands for them.
    #[serde(default)]
    words: BTreeMap<String, String>,
}

/// Values of contour lines, which are Courant numbers.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(try_from = "Vec<f64>")]
struct Levels(Vec<f64>);

impl TryFrom<Vec<f64>> for Levels {
    type Error = Refusal;

    fn try_from(levels: Vec<f64>) -> Result<Self, Refusal> {
        match levels.iter().find(|level| !(**level > 0.0 && level.is_finite())) {
            None => Ok(Self(levels)),
            Some(level) => Err(Refusal::new("levels", level, "finite numbers above 0")),
        }
    }
}

/// The keys of a style file.
const KEYS: &str = "title, x_label, y_label, x_limits, y_limits, levels, colour_map (viridis, cividis, batlow, grey), \
                    tags, text (paths, text), overlay, [words]";

impl Style {
    /// What the options ask for.
    ///
    /// # Errors
    /// A style file that cannot be read or has, by its line, what no style has; levels that are no Courant numbers.
    pub(super) fn new(options: &StyleOptions) -> Result<Self> {
        let mut style = options.style.as_deref().map(Self::load).transpose()?.unwrap_or_default();
        let one = || options.title.first().filter(|_| options.title.len() == 1).cloned();
        match one() {
            _ if options.no_title => style.title = Some(Titles::Shown(false)),
            Some(title) => style.title = Some(Titles::One(title)),
            None if !options.title.is_empty() => style.title = Some(Titles::Each(options.title.clone())),
            None => (),
        }
        if !options.levels.is_empty() {
            let levels = Levels::try_from(options.levels.clone());
            style.levels = Some(levels.map_err(|e| Refusal { place: "--levels".to_owned(), ..e })?);
        }
        style.x_label = options.x_label.clone().or(style.x_label);
        style.y_label = options.y_label.clone().or(style.y_label);
        style.x_limits = options.x_limits.or(style.x_limits);
        style.y_limits = options.y_limits.or(style.y_limits);
        style.colour_map = options.colour_map.or(style.colour_map);
        style.text = options.text.or(style.text);
        style.tags |= options.tags;
        style.overlay |= options.overlay;
        style.check_labels()?;
        Ok(style)
    }

    /// Refuses labels that no figure can print, before anything is computed.
    fn check_labels(&self) -> Result<(), Refusal> {
        let titles: &[String] = match &self.title {
            Some(Titles::One(title)) => std::slice::from_ref(title),
            Some(Titles::Each(titles)) => titles,
            Some(Titles::Shown(_)) | None => &[],
        };
        let titles = titles.iter().map(|title| ("title", title));
        let axes = [("x_label", &self.x_label), ("y_label", &self.y_label)];
        let axes = axes.into_iter().filter_map(|(place, label)| Some((place, label.as_ref()?)));
        let words = self.words.values().map(|word| ("words", word));
        for (place, label) in titles.chain(axes).chain(words) {
            figure::check_label(label).map_err(|error| {
                let allowed = "letters of DejaVu Sans; *..* italic, _{..} and ^{..} sub- and superscript, a backslash \
                               before any of these characters that is to be printed";
                Refusal::new(place, error, allowed)
            })?;
        }
        Ok(())
    }

    fn load(path: &Path) -> Result<Self> {
        let text = std::fs::read_to_string(path);
        let text = text.map_err(|source| Error::File { path: path.to_owned(), wanted: "read", source })?;
        toml::from_str(&text).map_err(|error| {
            let before = error.span().and_then(|span| text.get(..span.start)).unwrap_or_default();
            let line = before.matches('\n').count() + 1;
            let value = text.lines().nth(line - 1).unwrap_or_default().trim().to_owned();
            let place = format!("{}, line {line}", path.display());
            Refusal::new(place, format!("{value:?} ({})", error.message()), KEYS).into()
        })
    }

    /// The contour lines asked for.
    pub(super) fn levels(&self) -> Option<&[f64]> {
        self.levels.as_ref().map(|levels| levels.0.as_slice())
    }

    /// The ends of both axes that are asked for.
    pub(super) fn limits(&self) -> [Option<(f64, f64)>; 2] {
        [self.x_limits, self.y_limits].map(|limits| limits.map(|Limits(low, high)| (low, high)))
    }

    /// How many titles there are, if each panel has one.
    pub(super) fn titles(&self) -> Option<usize> {
        match &self.title {
            Some(Titles::Each(titles)) => Some(titles.len()),
            _ => None,
        }
    }

    /// The figure in this style.
    ///
    /// # Errors
    /// Titles of another number than the panels; maps to be laid over each other.
    pub(super) fn apply(&self, mut figure: Figure) -> Result<Figure, Refusal> {
        if self.overlay && figure.panels.len() > 1 {
            figure = overlaid(figure)?;
        }
        // Words first: a label that is asked for stands as it is.
        if !self.words.is_empty() {
            labels(&mut figure).into_iter().for_each(|label| self.translate(label));
        }
        self.entitle(&mut figure)?;
        for panel in &mut figure.panels {
            set(&mut panel.x, self.x_label.as_ref(), self.x_limits);
            set(&mut panel.y, self.y_label.as_ref(), self.y_limits);
        }
        if let (Some(bar), Some(map)) = (&mut figure.colour_bar, self.colour_map) {
            bar.map = map.into();
        }
        figure.tags |= self.tags;
        if self.text == Some(TextOption::Text) {
            figure.lettering = Lettering::Text;
        }
        Ok(figure)
    }

    fn entitle(&self, figure: &mut Figure) -> Result<(), Refusal> {
        let panels = figure.panels.len();
        match &self.title {
            None | Some(Titles::Shown(true)) => (),
            Some(Titles::Shown(false)) => figure.panels.iter_mut().for_each(|panel| panel.title = None),
            Some(Titles::One(title)) => {
                figure.panels.iter_mut().for_each(|panel| panel.title = Some(title.clone()));
            }
            Some(Titles::Each(titles)) if titles.len() == panels => {
                let pairs = figure.panels.iter_mut().zip(titles);
                pairs.for_each(|(panel, title)| panel.title = Some(title.clone()));
            }
            Some(Titles::Each(titles)) => {
                let allowed = format!("one title, or one for each of the {panels} panels");
                return Err(Refusal::new("title", format!("{} titles", titles.len()), allowed));
            }
        }
        Ok(())
    }

    /// Replaces each phrase, the longest first, so that a phrase may be part of another.
    fn translate(&self, label: &mut String) {
        let mut words: Vec<_> = self.words.iter().collect();
        words.sort_by_key(|(phrase, _)| std::cmp::Reverse(phrase.len()));
        for (phrase, word) in words.into_iter().filter(|(phrase, _)| !phrase.is_empty()) {
            *label = label.replace(phrase, word);
        }
    }
}

fn set(axis: &mut Axis, label: Option<&String>, limits: Option<Limits>) {
    if let Some(label) = label {
        axis.label.clone_from(label);
    }
    axis.range = limits.map(|Limits(low, high)| (low, high)).or(axis.range);
}

/// The label of a layer, if it has one.
fn label_of(layer: &mut Layer) -> Option<&mut String> {
    match layer {
        Layer::Curve { label, .. }
        | Layer::Markers { label, .. }
        | Layer::Exact { label, .. }
        | Layer::Rule { label, .. }
        | Layer::Shade { label, .. }
        | Layer::Contour { label, .. } => label.as_mut(),
        Layer::Cells { .. } | Layer::Patches { .. } => None,
    }
}

/// Everything that is written in a figure but numbers.
fn labels(figure: &mut Figure) -> Vec<&mut String> {
    let mut labels = Vec::new();
    for panel in &mut figure.panels {
        labels.extend(&mut panel.title);
        labels.extend([&mut panel.x.label, &mut panel.y.label]);
        labels.extend(panel.layers.iter_mut().filter_map(label_of));
    }
    labels.extend(figure.colour_bar.iter_mut().map(|bar| &mut bar.axis.label));
    labels.extend(figure.key.iter_mut().filter_map(label_of));
    labels
}

/// Panels that can be laid over each other: as many as there are colours that stay apart.
const OVERLAID: usize = 8;

/// All panels of a figure in one, on the axes of the first: each curve by the title of its panel and its name, in the
/// colour of its panel; what is shaded in one panel only says nothing of the others.
fn overlaid(mut figure: Figure) -> Result<Figure, Refusal> {
    let hides = |layer: &Layer| matches!(layer, Layer::Cells { .. } | Layer::Patches { .. });
    if figure.panels.iter().flat_map(|panel| &panel.layers).any(hides) {
        return Err(Refusal::new("--overlay", "maps", "curves, which do not hide one another"));
    }
    let wider = |one: Option<(f64, f64)>, other: Option<(f64, f64)>| {
        one.zip(other).map(|(one, other)| (one.0.min(other.0), one.1.max(other.1)))
    };
    let mut panels = figure.panels.into_iter();
    let Some(mut all) = panels.next() else { return Ok(Figure { panels: Vec::new(), ..figure }) };
    let rest: Vec<_> = panels.collect();
    if rest.len() >= OVERLAID {
        let value = format!("{} panels in one chart", rest.len() + 1);
        return Err(Refusal::new("--overlay", value, format!("at most {OVERLAID}, a colour each")));
    }
    let (mut layers, mut series): (Vec<Layer>, Vec<(usize, usize)>) = (Vec::new(), Vec::new());
    let first = std::mem::take(&mut all.layers);
    let parts = std::iter::once((all.title.take(), first)).chain(rest.into_iter().map(|panel| {
        all.x.range = wider(all.x.range, panel.x.range);
        all.y.range = wider(all.y.range, panel.y.range);
        (panel.title, panel.layers)
    }));
    for (colour, (title, part)) in parts.collect::<Vec<_>>().into_iter().enumerate() {
        for mut layer in part.into_iter().filter(|layer| !matches!(layer, Layer::Shade { .. })) {
            match &mut layer {
                // What had a colour of its own in its panel has a dash of its own in the chart.
                Layer::Curve { style, .. } => *style = figure::styled(colour, *style),
                // Markers have no dash: each series has another colour or shape, as long as there are some.
                Layer::Markers { style, .. } => {
                    let own = (colour, *style);
                    let known = series.iter().position(|known| *known == own).unwrap_or_else(|| {
                        series.push(own);
                        series.len() - 1
                    });
                    *style = known;
                }
                _ => (),
            }
            if let (Some(label), Some(title)) = (label_of(&mut layer), &title) {
                *label = format!("{title}, {label}");
            }
            layers.push(layer);
        }
    }
    all.layers = layers;
    figure.naming = figure::Naming::Legend;
    Ok(Figure { panels: vec![all], columns: 1, width: Width::Single, ..figure })
}
