//! What a user of the layer relies on, through its public interface.

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

    let mut figure = maps();
    figure.colour_bar = None;
    assert!(matches!(figure.svg(), Err(PlotError::NoColourBar)));

    let mut figure = curves();
    figure.panels[0].y.label = "a label that is much too long ".repeat(4);
    assert!(matches!(figure.svg(), Err(PlotError::LabelTooLong { .. })));

    let mut figure = curves();
    figure.columns = 20;
    figure.panels = vec![figure.panels[0].clone(); 20];
    assert!(matches!(figure.svg(), Err(PlotError::TooNarrow { .. })));
    figure.panels.clear();
    assert!(matches!(figure.svg(), Err(PlotError::NoPanels)));
}
