//! A figure as source for pgfplots, which sets it in the fonts of the paper. It reads its points from the records; what
//! no record holds, such as contour lines and exact solutions, is written out. The cells of a map are an image: as many
//! as a map has do not fit into TeX's memory, and have seams.

use std::fmt::Write as _;

use super::axes::power_note;
use super::canvas::Pen;
use super::cells::{Cells, colour};
use super::draw::{ArrangedPanel, Page, pen_of};
use super::error::PlotError;
use super::font::Fonts;
use super::frame::{Frame, Interval};
use super::layout::PlacedBar;
use super::model::{At, ColourMap, DataPoint, Figure, Layer, Scale, Side, Source};
use super::names::{Name, label_of};
use super::patches::Patches;
use super::tex_label::tex_label;
use super::theme::{Colour, MARKER, SHADE, Shape, series_colour, series_shape};
use super::ticks::Ticks;

/// What every source begins with; sizes as in the other formats.
const HEAD: &str = r"% Compile with pdflatex or lualatex, or \input it with \usepackage{standalone}. The csv files it reads lie beside it.
\documentclass[border=1mm]{standalone}
\usepackage{pgfplots}
\pgfplotsset{
  compat=1.16,
  filter discard warning=false,
  rows/.style args={#1 to #2}{x filter/.code={%
    \ifnum\coordindex<#1\relax\def\pgfmathresult{}\fi\ifnum\coordindex>#2\relax\def\pgfmathresult{}\fi}},
  panel/.style={
    scale only axis, anchor=south west, axis on top, tick align=outside, tick pos=left, unbounded coords=jump,
    tick style={black, line width=0.5pt}, major tick length=1mm, minor tick length=0.6mm,
    tick label style={font=\scriptsize}, label style={font=\footnotesize, inner sep=1pt},
    title style={font=\footnotesize, yshift=-1ex},
    legend style={font=\footnotesize, draw=none, anchor=north, legend columns=-1, column sep=1mm},
  },
}
\begin{document}
\begin{tikzpicture}[x=1mm, y=1mm, name/.style={font=\footnotesize, inner sep=0.5pt}]
";

/// TeX source and the images it places, by name.
#[derive(Debug, Clone, PartialEq)]
pub struct TexSource {
    /// The source.
    pub text: String,
    /// Names without folder and ending, and PNG files.
    pub images: Vec<(String, Vec<u8>)>,
}

impl Figure {
    /// The figure as TeX source for pgfplots that reads the points of a layer from its records, if it has some. The
    /// names of images begin with `stem`.
    ///
    /// # Errors
    /// As [`Figure::svg`].
    pub fn tex(&self, stem: &str) -> Result<TexSource, PlotError> {
        let fonts = Fonts::new()?;
        let page = self.arrange(&fonts)?;
        let (mut tex, mut images) = (HEAD.to_owned(), Vec::new());
        for (index, arranged) in page.panels.iter().enumerate() {
            images.extend(cells(&mut tex, &page, (arranged, &fonts), &format!("{stem}-cells{}", index + 1))?);
            panel(&mut tex, &page, index)?;
            for name in &arranged.names.placed {
                draw_name(&mut tex, &page, arranged, name)?;
            }
        }
        tex.push_str("\\end{tikzpicture}\n\\end{document}\n");
        Ok(TexSource { text: tex, images })
    }
}

/// Places the coloured cells of a panel, if it has some; their image.
fn cells(
    tex: &mut String,
    page: &Page,
    (arranged, fonts): (&ArrangedPanel, &Fonts),
    name: &str,
) -> Result<Option<(String, Vec<u8>)>, PlotError> {
    let (panel, frame) = (arranged.placed.panel, &arranged.placed.frame);
    let Some(bar) = &page.bar else { return Ok(None) };
    let colours = (bar.bar.map, bar.interval);
    let image = match panel
        .layers
        .iter()
        .find(|layer| matches!(layer, Layer::Cells { .. } | Layer::Patches { .. }))
    {
        Some(Layer::Cells { x, y, values }) => {
            Cells::new((panel, frame), (x, y, values), colours)?.image()?
        }
        Some(Layer::Patches { polygons, values, outlines }) => {
            let patches = Patches::new(frame, (polygons, values, outlines), colours)?;
            Some((patches.image(fonts)?, frame.rect))
        }
        _ => None,
    };
    Ok(image.map(|(png, place)| {
        let _ = writeln!(
            tex,
            "\\node[anchor=south west, inner sep=0pt] at ({:.2},{:.2})\n  \
             {{\\includegraphics[width={:.2}mm, height={:.2}mm]{{{name}}}}};",
            place.left,
            page.height - place.bottom,
            place.width(),
            place.height()
        );
        (name.to_owned(), png)
    }))
}

/// One axis environment with its layers.
fn panel(tex: &mut String, page: &Page, index: usize) -> Result<(), PlotError> {
    let arranged = &page.panels[index];
    let (placed, rect) = (&arranged.placed, arranged.placed.frame.rect);
    let panel = placed.panel;
    // Writing to a String cannot fail, here and below.
    let _ = writeln!(
        tex,
        "\\begin{{axis}}[panel, at={{({:.2}mm,{:.2}mm)}}, width={:.2}mm, height={:.2}mm,",
        rect.left,
        page.height - rect.bottom,
        rect.width(),
        rect.height()
    );
    if placed.tag.is_some() || panel.title.is_some() {
        let parts = placed.tag.iter().chain(&panel.title).map(|part| tex_label(part));
        let title = parts.collect::<Result<Vec<_>, _>>()?.join(" ");
        let _ = writeln!(tex, "  title={{{title}}},");
    }
    axis(tex, 'x', placed.frame.x, &placed.x_ticks, &panel.x.label)?;
    axis(tex, 'y', placed.frame.y, &placed.y_ticks, &panel.y.label)?;
    let first = index == 0;
    if first && page.legend.height() > 0.0 {
        let across = (page.width / 2.0 - rect.left) / rect.width();
        let _ = writeln!(
            tex,
            "  legend style={{at={{({across:.4},{:.4})}}}},",
            (rect.bottom - page.height) / rect.height()
        );
    }
    if let Some(bar) = &page.bar {
        colour_bar(tex, bar, is_last_of_row(page, index))?;
    }
    tex.push_str("]\n");
    for layer in &panel.layers {
        draw_layer(tex, layer, &placed.frame);
    }
    for layer in page.legend.layers().filter(|_| first) {
        let name = tex_label(label_of(layer).unwrap_or_default())?;
        let _ = writeln!(tex, "\\addlegendimage{{{}}}\\addlegendentry{{{name}}}", style(layer));
    }
    tex.push_str("\\end{axis}\n");
    Ok(())
}

/// Whether the panel ends the first row, where the colour bar stands.
fn is_last_of_row(page: &Page, index: usize) -> bool {
    let top = |index: usize| page.panels.get(index).map(|arranged| arranged.placed.frame.rect.top);
    top(index) == top(0) && top(index + 1) != top(0)
}

/// Range, ticks and label of one axis.
fn axis(
    tex: &mut String,
    name: char,
    interval: Interval,
    ticks: &Ticks,
    label: &str,
) -> Result<(), PlotError> {
    if interval.scale == Scale::Log {
        let _ = write!(tex, "  {name}mode=log,");
    }
    let note = power_note(ticks).map_or_else(String::new, |note| format!(" ({note})"));
    let _ = writeln!(
        tex,
        "  {name}min={:e}, {name}max={:e}, {name}label={{{}}},",
        interval.low,
        interval.high,
        tex_label(&format!("{label}{note}"))?
    );
    let (places, names) = major(ticks, |value| value)?;
    let minor: Vec<String> = ticks.minor.iter().map(|value| format!("{value:e}")).collect();
    let _ = writeln!(tex, "  {name}tick={{{places}}}, {name}ticklabels={{{names}}},");
    let _ = writeln!(tex, "  minor {name}tick={{{}}},", minor.join(","));
    Ok(())
}

/// Places and labels of the long ticks.
fn major(ticks: &Ticks, place: impl Fn(f64) -> f64) -> Result<(String, String), PlotError> {
    let places: Vec<String> = ticks.major.iter().map(|(value, _)| format!("{:e}", place(*value))).collect();
    let name = |(_, label): &(f64, String)| Ok(format!("{{{}}}", tex_label(label)?));
    let names: Vec<String> = ticks.major.iter().map(name).collect::<Result<_, PlotError>>()?;
    Ok((places.join(","), names.join(",")))
}

/// Colours of the cells; values on a logarithmic bar are coloured by their power of ten.
fn colour_bar(tex: &mut String, placed: &PlacedBar, visible: bool) -> Result<(), PlotError> {
    let of = |value: f64| if placed.interval.scale == Scale::Log { value.log10() } else { value };
    let map = match placed.bar.map {
        ColourMap::Viridis => " name=viridis".to_owned(),
        ColourMap::Cividis => " name=cividis".to_owned(),
        ColourMap::Grey => " name=blackwhite".to_owned(),
        // Unknown to pgfplots: by their colours.
        map @ (ColourMap::Batlow | ColourMap::BlueRed) => {
            let shares = (0..=16).map(|step| colour(map, f64::from(step) / 16.0));
            let colours: Vec<String> = shares.map(|(r, g, b)| format!("rgb255=({r},{g},{b})")).collect();
            let name = if map == ColourMap::Batlow { "batlow" } else { "bluered" };
            format!("={{{name}}}{{{}}}", colours.join(" "))
        }
    };
    let (low, high) = (of(placed.interval.low), of(placed.interval.high));
    let _ = writeln!(tex, "  colormap{map}, point meta min={low:e}, point meta max={high:e},");
    if visible {
        let (places, names) = major(&placed.ticks, of)?;
        let _ = writeln!(
            tex,
            "  colorbar, colorbar style={{width=3mm, ytick pos=right, ylabel={{{}}}, ytick={{{places}}}, yticklabels={{{names}}}}},",
            tex_label(&placed.bar.axis.label)?
        );
    }
    Ok(())
}

fn draw_layer(tex: &mut String, layer: &Layer, frame: &Frame) {
    let style = style(layer);
    // Below a line means down to zero, which must lie at the lower edge or outside.
    let end = match layer {
        Layer::Shade { side: Side::Below, .. } if frame.y.low >= 0.0 => " \\closedcycle",
        _ => "",
    };
    if let Some(Source { file, columns, rows: (first, last) }) =
        layer.source().filter(|_| !end.is_empty() || !matches!(layer, Layer::Shade { .. }))
    {
        let _ = writeln!(
            tex,
            "\\addplot[forget plot, {style}, rows={first} to {last}]\n  \
             table[col sep=comma, x={}, y={}] {{{file}}}{end};",
            columns[0], columns[1]
        );
        return;
    }
    let mut plot = |points: &[DataPoint], end: &str| {
        let _ = writeln!(tex, "\\addplot[forget plot, {style}] coordinates {{{}}}{end};", list(points));
    };
    match layer {
        // Placed as an image before the axes.
        Layer::Cells { .. } | Layer::Patches { .. } => (),
        Layer::Curve { points, .. } | Layer::Markers { points, .. } => plot(points, ""),
        Layer::Exact { points, .. } => plot(points, ""),
        Layer::Contour { lines, .. } => lines.iter().for_each(|line| plot(line, "")),
        Layer::Rule { at: At::X(x), .. } => plot(&[(*x, frame.y.low), (*x, frame.y.high)], ""),
        Layer::Rule { at: At::Y(y), .. } => plot(&[(frame.x.low, *y), (frame.x.high, *y)], ""),
        Layer::Shade { points, side, .. } => {
            let edge = if *side == Side::Below { frame.y.low } else { frame.y.high };
            for run in points.split(|(x, y)| !(x.is_finite() && y.is_finite())) {
                if let (Some(first), Some(last)) = (run.first(), run.last()) {
                    let corners = [(last.0, edge), (first.0, edge)];
                    plot(&[run, &corners].concat(), " -- cycle");
                }
            }
        }
    }
}

/// Points as pgfplots reads them.
fn list(points: &[DataPoint]) -> String {
    points.iter().fold(String::new(), |mut list, (x, y)| {
        let separator = if list.is_empty() { "" } else { " " };
        let _ = write!(list, "{separator}({x:e},{y:e})");
        list
    })
}

/// How a layer looks.
fn style(layer: &Layer) -> String {
    let pen = pen_of(layer).map_or_else(|| "draw=none".to_owned(), line_style);
    match layer {
        Layer::Markers { style, joined, .. } => {
            let (colour, (shape, filled)) = (colour_of(series_colour(*style)), series_shape(*style));
            let mark = match shape {
                Shape::Circle => "*",
                Shape::Polygon { corners: 3, .. } => "triangle*",
                Shape::Polygon { turn: 0.0, .. } => "diamond*",
                Shape::Polygon { .. } => "square*",
            };
            let inside = if filled { colour.clone() } else { "white".to_owned() };
            let line = if *joined { pen } else { "only marks".to_owned() };
            let options = format!("mark options={{solid, draw={colour}, fill={inside}}}");
            format!("{line}, mark={mark}, mark size={MARKER}mm, {options}")
        }
        Layer::Shade { .. } => format!("draw=none, fill={}, area legend", colour_of(SHADE)),
        Layer::Contour { .. } => format!("{pen}, preaction={{draw=white, line width=1.5pt}}"),
        _ => pen,
    }
}

fn line_style(pen: Pen) -> String {
    let mut style = format!("no markers, draw={}, line width={}pt", colour_of(pen.colour), pen.width);
    if !pen.dash.is_empty() {
        let parts = pen.dash.iter().zip(["on", "off"].iter().cycle());
        let dashes: Vec<String> = parts.map(|(length, word)| format!("{word} {length}mm")).collect();
        let _ = write!(style, ", dash pattern={}", dashes.join(" "));
    }
    style
}

fn colour_of(colour: Colour) -> String {
    format!("{{rgb,255:red,{};green,{};blue,{}}}", colour.0, colour.1, colour.2)
}

/// A name at its place on the page, with the line that leads to it.
fn draw_name(tex: &mut String, page: &Page, arranged: &ArrangedPanel, name: &Name) -> Result<(), PlotError> {
    let layer = &arranged.placed.panel.layers[name.layer];
    let label = tex_label(label_of(layer).unwrap_or_default())?;
    let colour = colour_of(name.colour);
    if let Some([from, to]) = name.leader {
        let (up, down) = (page.height - from.1, page.height - to.1);
        let _ = writeln!(
            tex,
            "\\draw[draw={colour}, line width=0.6pt] ({:.2},{up:.2}) -- ({:.2},{down:.2}) \
             node[name, right=2pt, text={colour}] {{{label}}};",
            from.0, to.0
        );
        return Ok(());
    }
    let on_map = arranged.placed.panel.layers.iter().any(|layer| matches!(layer, Layer::Cells { .. }));
    let paper = if on_map { ", fill=white, fill opacity=0.8, text opacity=1" } else { "" };
    let _ = writeln!(
        tex,
        "\\node[name, text={colour}, rotate={:.1}{paper}] at ({:.2},{:.2}) {{{label}}};",
        -name.turn,
        name.centre.0,
        page.height - name.centre.1
    );
    Ok(())
}
