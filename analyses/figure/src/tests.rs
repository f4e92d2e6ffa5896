//! What a user of the layer relies on, through its public interface.

use super::font::Fonts;
use super::layout::{layout, side_width};
use super::*;

fn decay(rate: f64) -> Vec<DataPoint> {
    let x = (0..=100).map(|i| f64::from(i) / 10.0);
    x.map(|x| (x, 1.0 / (1.0 + rate * x).sqrt())).collect()
}

fn curves() -> Figure {
    let layers = vec![
        Layer::curve(decay(0.3), "*r* = 3", 0),
        Layer::curve(decay(1.0), "*r* = ∞", 1),
        Layer::markers(vec![(2.0, 0.9), (4.0, 0.8)], "stepping", 2),
    ];
    let (x, y) = (Axis::linear("*β*_{s}"), Axis::linear("*C*_{r}"));
    Figure::new(Width::Single, vec![Panel::new(x, y, layers)])
}

/// Two panels with maps, as a picture and as rectangles.
fn maps() -> Figure {
    let x: Vec<f64> = (-3..=3).map(|e| 10_f64.powi(e)).collect();
    let values = (0..49).map(|i| if i == 7 { f64::NAN } else { f64::from(i) });
    let cells = Layer::Cells { x: x.clone(), y: x, values: values.collect() };
    let panel = Panel::new(Axis::log("*β*_{s}"), Axis::log("*r*"), vec![cells]);
    let mut figure = Figure::new(Width::Double, vec![panel.clone(), panel]);
    figure.colour_bar = Some(ColourBar { axis: Axis::linear("*C*_{r}"), map: ColourMap::default() });
    figure
}

#[test]
fn equal_figures_give_equal_bytes() {
    for figure in [curves(), maps()] {
        let svg = figure.svg().expect("valid figure");
        let png = figure.png().expect("valid figure");
        let pdf = figure.pdf().expect("valid figure");
        // Hash tables are seeded anew each time: a few rounds would show their order.
        for _ in 0..4 {
            assert!(figure.svg().expect("valid figure") == svg, "SVG");
            assert!(figure.png().expect("valid figure") == png, "PNG");
            assert!(figure.pdf().expect("valid figure") == pdf, "PDF");
        }
    }
}

#[test]
fn every_format_has_the_printed_size() {
    let svg = curves().svg().expect("valid figure");
    assert!(svg.contains("width=\"90mm\""));
    // 90 mm at 300 dots per inch, in the header of the PNG.
    let png = curves().png().expect("valid figure");
    assert_eq!(png[16..20], 1063_u32.to_be_bytes());
    assert!(png.windows(4).any(|bytes| bytes == b"pHYs"));
    // 90 mm in points.
    let pdf = curves().pdf().expect("valid figure");
    let text = String::from_utf8_lossy(&pdf);
    assert!(text.contains("/MediaBox [0 0 255.1"));
    assert!(text.contains("+DejaVuSans") && text.contains("/FontFile2"));
}

#[test]
fn no_markup_is_printed() {
    let svg = curves().svg().expect("valid figure");
    let labels = svg.split("aria-label=\"").skip(1);
    let labels: Vec<&str> = labels.filter_map(|rest| rest.split('"').next()).collect();
    assert!(labels.contains(&"Cr") && labels.contains(&"r = ∞"), "{labels:?}");
    assert!(!labels.iter().any(|label| label.contains(['_', '^', '*', '{'])), "{labels:?}");
}

#[test]
fn mistakes_are_named() {
    let mut figure = curves();
    figure.panels[0].x.scale = Scale::Log;
    assert!(matches!(figure.svg(), Err(PlotError::NotPositive { value, .. }) if value == 0.0));

    let mut figure = curves();
    figure.panels[0].layers.push(Layer::curve(vec![(0.0, f64::NAN)], "empty", 3));
    assert!(matches!(figure.svg(), Err(PlotError::EmptyLayer { label, .. }) if label == "empty"));

    let mut figure = curves();
    figure.panels[0].y.range = Some((5.0, 6.0));
    let stable = Layer::Shade { points: decay(1.0), side: Side::Below, label: None, source: None };
    figure.panels[0].layers.push(stable);
    assert!(matches!(figure.svg(), Err(PlotError::NothingVisible)));
    assert!(matches!(check_label("C_r"), Err(PlotError::Markup { .. })));
    assert!(matches!(check_label("time 時"), Err(PlotError::Character { character: '時', .. })));

    let mut figure = maps();
    figure.colour_bar = None;
    assert!(matches!(figure.svg(), Err(PlotError::NoColourBar)));

    let mut figure = curves();
    figure.panels[0].y.label = "a label that is much too long ".repeat(4);
    assert!(matches!(figure.svg(), Err(PlotError::LabelTooLong { .. })));

    let mut figure = curves();
    figure.panels[0].y = Axis::linear("*C*_{r}")
        .named(0.5, "a number that leaves no room for the chart of it at all, whatever is done");
    assert!(matches!(figure.svg(), Err(PlotError::TooNarrow { .. })));
    figure.panels.clear();
    assert!(matches!(figure.svg(), Err(PlotError::NoPanels)));
}

/// Names of the panels of one column that are drawn, from the SVG.
fn count(svg: &str, label: &str) -> usize {
    svg.matches(&format!("aria-label=\"{label}\"")).count()
}

#[test]
fn alike_axes_are_labelled_once_and_others_each() {
    let mut figure = curves();
    figure.panels = vec![figure.panels[0].clone(); 6];
    figure.width = Width::Double;
    figure.columns = 2;
    let svg = figure.svg().expect("valid figure");
    // Two columns and three rows: below the lowest and left of the first.
    assert_eq!((count(&svg, "βs"), count(&svg, "Cr")), (2, 3));
    // Five panels: above the hole there are numbers, and beside it too.
    figure.panels.pop();
    let svg = figure.svg().expect("valid figure");
    assert_eq!((count(&svg, "βs"), count(&svg, "Cr")), (3, 3));
    // Another range in the first panel: its row and the column on its right have labels of their own.
    figure.panels[0].x.range = Some((0.0, 5.0));
    figure.panels[0].y.range = Some((0.0, 2.0));
    let svg = figure.svg().expect("valid figure");
    assert_eq!((count(&svg, "βs"), count(&svg, "Cr")), (5, 5));
}

#[test]
fn as_many_columns_as_the_labels_allow() {
    let height = |figure: &Figure| -> f64 {
        let svg = figure.svg().expect("valid figure");
        let (_, rest) = svg.split_once("height=\"").expect("a height");
        rest.split_once("mm").and_then(|(number, _)| number.parse().ok()).expect("a number")
    };
    let mut figure = curves();
    figure.panels = vec![figure.panels[0].clone(); 4];
    let in_columns = |figure: &Figure, columns: usize| height(&Figure { columns, ..figure.clone() });
    let (one, two) = (in_columns(&figure, 1), in_columns(&figure, 2));
    // Four are too narrow to be drawn at all.
    let four = in_columns(&figure, 4);
    assert!(1.2 * four < one && 1.2 * two < one, "{one} {two} {four}");
    // A title as wide as the page stands above one panel only.
    figure.panels[3].title = Some("a title that has no room above half of a column".to_owned());
    let (alone, beside) = (in_columns(&figure, 1), in_columns(&figure, 2));
    assert!(alone == beside && beside > 1.2 * two, "{alone} {beside} {two}");
}

#[test]
fn a_title_clears_the_power_of_ten_of_its_axis() {
    let tops = |title: &str| -> Vec<f64> {
        let mut figure = curves();
        let small = decay(1.0).into_iter().map(|(x, y)| (x, 1e-5 * y)).collect();
        figure.panels[0].layers = vec![Layer::curve(small, "*r*", 0)];
        figure.panels[0].title = Some(title.to_owned());
        let svg = figure.svg().expect("valid figure");
        let top = |label: &str| {
            let (before, _) = svg.split_once(&format!("\" aria-label=\"{label}\"")).expect("the label");
            let (_, place) = before.rsplit_once("translate(").expect("a place");
            place.trim_end_matches(')').split(' ').nth(1).and_then(|y| y.parse().ok()).expect("a number")
        };
        vec![top(title), top("×10−5")]
    };
    let short = tops("short");
    let long = tops("a title that is as long as the frame is");
    // Hundredths of a millimetre: beside each other, and one above the other.
    assert!((short[0] - short[1]).abs() < 100.0 && long[1] - long[0] > 200.0, "{short:?} {long:?}");
}

#[test]
fn styles_are_made_of_a_colour_and_a_dash() {
    for colour in 0..9 {
        for dash in 0..9 {
            let style = styled(colour, dash);
            assert_eq!(theme::series_colour(style), theme::series_colour(colour));
            assert_eq!(theme::series_dash(style), theme::series_dash(dash));
        }
    }
}

/// Numbers of an axis that is too short for all of them: none lies on another, and two powers of ten stay.
#[test]
fn labels_of_a_short_axis_do_not_lie_on_each_other() {
    let mut figure = curves();
    figure.panels.truncate(1);
    figure.panels = vec![figure.panels[0].clone(); 2];
    figure.columns = 2;
    for panel in &mut figure.panels {
        panel.x = Axis { range: Some((2e-5, 2e-3)), ..Axis::log("t") };
        let points = vec![(3e-5, 0.5), (1e-3, 0.8)];
        panel.layers = vec![Layer::markers(points, "stepping", 2)];
    }
    let svg = figure.svg().expect("valid figure");
    let shown = |label: &str| count(&svg, label);
    assert!(shown("10−4") > 0 && shown("10−3") > 0, "{svg}");
    assert_eq!(shown("5·10−5") + shown("2·10−4") + shown("5·10−4"), 0);
}

/// Two unit squares beside each other.
fn squares() -> Figure {
    let square = |x: f64| vec![(x, 0.0), (x + 1.0, 0.0), (x + 1.0, 1.0), (x, 1.0)];
    let layer = Layer::Patches {
        polygons: vec![square(0.0), square(1.0)],
        values: vec![-3.0, 3.0],
        outlines: vec![square(0.0)],
    };
    let panel = Panel::new(Axis::linear("*x* [m]"), Axis::linear("*y* [m]"), vec![layer]);
    let mut figure = Figure::new(Width::Single, vec![panel]);
    figure.colour_bar = Some(ColourBar { axis: Axis::linear("*σ* [Pa]"), map: ColourMap::BlueRed });
    figure.equal = true;
    figure
}

/// The points of each mark with this fill, hundredths of a millimetre.
fn corners(svg: &str, fill: &str) -> Vec<(f64, f64)> {
    let marks = svg.lines().filter(|line| line.contains(fill) && line.contains("stroke-width=\"6\""));
    let points = marks.filter_map(|line| Some(line.split_once("points=\"")?.1.split_once('"')?.0));
    let point = |text: &str| {
        let (x, y) = text.split_once(',').expect("a point");
        (x.parse().expect("a number"), y.parse().expect("a number"))
    };
    points.flat_map(|text| text.split_whitespace().map(point).collect::<Vec<_>>()).collect()
}

#[test]
fn patches_have_the_colours_of_the_ends_and_equal_sides() {
    for aspect in [0.2, 0.7, 2.0] {
        let svg = Figure { aspect, ..squares() }.svg().expect("valid figure");
        assert_eq!(svg.matches("stroke-width=\"6\"").count(), 2);
        // The values are the ends of the bar.
        for share in [0.0, 1.0] {
            let (red, green, blue) = cells::colour(ColourMap::BlueRed, share);
            let fill = format!("fill=\"#{red:02x}{green:02x}{blue:02x}\"");
            let corners = corners(&svg, &fill);
            assert_eq!(corners.len(), 4, "{fill}");
            let extent = |of: fn(&(f64, f64)) -> f64| {
                let values = corners.iter().map(of);
                values.clone().fold(f64::NEG_INFINITY, f64::max) - values.fold(f64::INFINITY, f64::min)
            };
            // Places are rounded to a unit at both ends.
            assert!(
                (extent(|p| p.0) - extent(|p| p.1)).abs() <= 2.0 && extent(|p| p.0) > 500.0,
                "{corners:?}"
            );
        }
    }
    let mut figure = squares();
    let Layer::Patches { values, .. } = &mut figure.panels[0].layers[0] else { panic!("patches") };
    values.pop();
    assert!(matches!(figure.svg(), Err(PlotError::PatchCount { polygons: 2, values: 1 })));
}

#[test]
fn patches_are_drawn_in_every_format() {
    let tex = squares().tex("stress").expect("valid figure");
    assert_eq!(tex.images.len(), 1);
    assert!(tex.text.contains("{stress-cells1}") && tex.text.contains("colormap={bluered}"));
    assert!(squares().pdf().expect("valid figure").starts_with(b"%PDF"));
    // Many are an image, as large as they would be alone.
    let mut many = squares();
    let Layer::Patches { polygons, values, .. } = &mut many.panels[0].layers[0] else { panic!("patches") };
    *polygons = polygons.iter().cycle().take(20_001).cloned().collect();
    values.resize(20_001, 3.0);
    let svg = many.svg().expect("valid figure");
    assert!(svg.contains("<image") && !svg.contains("stroke-width=\"6\""));
}

/// The ticks of a bar depend on the size of the frames, which depends on the room that the ticks leave.
#[test]
fn the_bar_of_equal_frames_stays_on_the_page() {
    let fonts = Fonts::new().expect("fonts");
    for tenth in 10..100 {
        for (width, tall) in
            [(Width::Single, 0.2), (Width::Single, 0.05), (Width::Double, 0.2), (Width::Double, 1.0)]
        {
            let mut figure = squares();
            let Layer::Patches { polygons, values, outlines } = &mut figure.panels[0].layers[0] else {
                panic!("patches")
            };
            for point in polygons.iter_mut().chain(outlines).flatten() {
                point.0 *= tall;
            }
            *values = vec![-1e6 * f64::from(tenth), 1e6 * f64::from(tenth)];
            figure.panels = vec![figure.panels[0].clone(); 3];
            (figure.width, figure.aspect) = (width, 2.0);
            let laid = layout(&figure, 2, &fonts, 0.0).expect("a layout");
            let bar = laid.bar.expect("a bar");
            let end = bar.rect.right + side_width(&bar.bar.axis, &bar.ticks, &fonts).expect("a width");
            assert!(end <= figure.width.millimetres() + 1e-9, "{tenth} {width:?} {tall}: {end}");
        }
    }
}
