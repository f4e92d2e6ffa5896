//! Every option of every tool with a run that shows its effect.

use Seen::{All, Column, Holds, Other, Refused};

use crate::tool::Scratch;

pub const BAR: &str = "signorini --elements 2 --mass lumped";
pub const POINTS: &str = "signorini --elements 2 --mass lumped --beta-s 1,2";
pub const IMPACT: &str = "signorini --elements 4 --mass lumped --beta-s 1 --scheme park";

const OPENING: &str = "signorini --elements 4 --mass lumped --scheme park --beta-s 1 --ratio 1 --contact opening --fraction 0.5";

/// What a run must show; the records are those of `--stdout csv`.
#[derive(Clone, Copy)]
pub enum Seen {
    /// This column of the records has these values, row by row.
    Column(&'static str, &'static [&'static str]),
    /// This column has this value in every row.
    All(&'static str, &'static str),
    /// The records are others than those of the run with these arguments.
    Other(&'static str),
    /// Exit status 2 and a message with this word.
    Refused(&'static str),
    /// With `--out there --format csv`, the files pass.
    Holds(fn(&Scratch)),
}

/// tool, option, all arguments, what must be seen.
pub const USES: &[(&str, &str, &str, Seen)] = &[
    ("mesh-limits", "--quick", "rules --quick", All("study", "rules")),
    ("impact-studies", "--quick", "penalty --quick", All("study", "penalty")),
    (
        "stability-map",
        "--elements",
        "hunek --elements 3 --mass lumped --beta-s 1 --ratio 1",
        Column("elements", &["9"]),
    ),
    (
        "stability-map",
        "--mass",
        "signorini --mass 0.3,lumped --beta-s 1 --ratio 1",
        Column("gamma", &["0.3", "1.0"]),
    ),
    (
        "stability-map",
        "--penalty-mass",
        "symmetric --mass lumped --beta-s 5 --ratio 0.5 --penalty-mass diagonalised",
        Other("symmetric --mass lumped --beta-s 5 --ratio 0.5"),
    ),
    (
        "stability-map",
        "--beta-s",
        "signorini --mass lumped --beta-s lin:1:3:3 --ratio 1",
        Column("stiffness_penalty", &["1.0", "2.0", "3.0"]),
    ),
    (
        "stability-map",
        "--ratio",
        "signorini --mass lumped --beta-s 1 --ratio 3,inf",
        Column("ratio", &["3.0", "inf"]),
    ),
    (
        "stability-map",
        "--relative-courant",
        "signorini --mass lumped --limit predictor-corrector --beta-s 1e3 --ratio plastic --relative-courant 0.25",
        Holds(|scratch| {
            // dt^2 s' mu = 1 at this step: eight roundings on the way to the limit that is printed.
            let records = text(scratch, "there/signorini-lumped-predictor-corrector.csv");
            let courant: f64 = column(&records, "critical_courant")[0].parse().unwrap();
            assert!((courant / 0.25 - 1.0).abs() < 8.0 * f64::EPSILON, "{courant}");
        }),
    ),
    (
        "stability-map",
        "--limit",
        "signorini --mass lumped --beta-s 1 --ratio 1 --limit park",
        Column("limit", &["park"]),
    ),
    (
        "stability-map",
        "--theta",
        "signorini --mass lumped --beta-s 1 --ratio 1 --limit park --theta 0",
        Other("signorini --mass lumped --beta-s 1 --ratio 1 --limit park"),
    ),
    (
        "stability-map",
        "--engine",
        "signorini --mass lumped --beta-s 1 --ratio 2 --engine sturm",
        Column("engine", &["sturm"]),
    ),
    (
        "optimal-ratio",
        "--elements",
        "hunek --elements 3 --mass lumped --beta-s 1",
        Column("elements", &["9"]),
    ),
    ("optimal-ratio", "--mass", "signorini --mass 0.3,lumped --beta-s 1", Column("gamma", &["0.3", "1.0"])),
    (
        "optimal-ratio",
        "--penalty-mass",
        "symmetric --elements 2 --mass lumped --beta-s 1 --penalty-mass diagonalised",
        Other("symmetric --elements 2 --mass lumped --beta-s 1"),
    ),
    (
        "optimal-ratio",
        "--beta-s",
        "signorini --mass lumped --beta-s lin:1:3:3",
        Column("stiffness_penalty", &["1.0", "2.0", "3.0"]),
    ),
    (
        "optimal-ratio",
        "--limit",
        "signorini --mass lumped --beta-s 1e3 --limit predictor-corrector",
        Column("limit", &["predictor-corrector"]),
    ),
    // Every ratio costs the Park scheme a step, whatever theta: the refusal of a wrong one shows that it is read.
    (
        "optimal-ratio",
        "--theta",
        "signorini --mass lumped --beta-s 1 --limit park --theta 2",
        Refused("theta"),
    ),
    (
        "stability-map",
        "--parameter",
        "signorini --mass lumped --limit noh-bathe --parameter 0.6 --beta-s 1 --ratio 1",
        Other("signorini --mass lumped --limit noh-bathe --beta-s 1 --ratio 1"),
    ),
    (
        "stability-map",
        "--damping-mass",
        "signorini --mass lumped --beta-s 1 --ratio 1 --damping-mass 10",
        All("limit", "damped-central-difference"),
    ),
    (
        "stability-map",
        "--damping-stiffness",
        "signorini --mass lumped --beta-s 1 --ratio 1 --damping-stiffness 1e-4",
        Other("signorini --mass lumped --beta-s 1 --ratio 1 --damping-mass 10"),
    ),
    (
        "stability-map",
        "--damping-contact",
        "signorini --mass lumped --beta-s 1 --ratio inf --damping-contact 1e-3",
        Other("signorini --mass lumped --beta-s 1 --ratio inf"),
    ),
    (
        "stability-map",
        "--stiffness",
        "signorini --mass lumped --stiffness 1e4,2e4 --ratio 1",
        Column("penalty_stiffness", &["10000.0", "20000.0"]),
    ),
    (
        "stability-map",
        "--time-step",
        "signorini --mass lumped --time-step 9e-4 --beta-s 10 --ratio 1",
        Column("within", &["true"]),
    ),
    // Only a drawing has units: the refusal of records without seconds shows that they are read.
    ("stability-map", "--units", "signorini --units imperial", Refused("units")),
    (
        "optimal-ratio",
        "--parameter",
        "signorini --mass lumped --beta-s 1 --limit noh-bathe --parameter 2",
        Refused("--parameter"),
    ),
    ("optimal-ratio", "--damping-mass", "signorini --beta-s 1 --damping-mass 1", Refused("not derived")),
    (
        "optimal-ratio",
        "--damping-stiffness",
        "signorini --mass lumped --beta-s 1 --limit predictor-corrector --damping-stiffness 1e-4",
        All("limit", "damped-predictor-corrector"),
    ),
    (
        "optimal-ratio",
        "--damping-contact",
        "signorini --beta-s 1 --damping-contact -1",
        Refused("--damping-contact"),
    ),
    ("stability-map", "--patch", "signorini --mass lumped --beta-s 1 --patch 2", Refused("--patch")),
    (
        "stability-map",
        "--tolerance",
        "signorini --mass lumped --beta-s 1 --tolerance 2",
        Refused("--tolerance"),
    ),
    ("optimal-ratio", "--patch", "signorini --mass lumped --beta-s 1 --patch 2", Refused("--patch")),
    (
        "optimal-ratio",
        "--tolerance",
        "signorini --mass lumped --beta-s 1 --tolerance 2",
        Refused("--tolerance"),
    ),
    ("stability-map", "--from", "--from missing.csv", Refused("missing.csv")),
    ("optimal-ratio", "--from", "--from missing.csv", Refused("missing.csv")),
    (
        "optimal-ratio",
        "--stiffness",
        "signorini --mass lumped --stiffness 1e4,2e4",
        Column("penalty_stiffness", &["10000.0", "20000.0"]),
    ),
    (
        "optimal-ratio",
        "--units",
        "signorini --elements 2 --mass lumped --stiffness 1e2,1e4 --units si --format svg",
        Holds(|scratch| assert!(text(scratch, "there/signorini-lumped-s100-1e4-n2.svg").contains("(N/m)"))),
    ),
    (
        "scheme-limits",
        "--units",
        "signorini --elements 2 --mass lumped --units si --format svg",
        Holds(|scratch| assert!(text(scratch, "there/fig3-signorini-lumped-n2.svg").contains("(N/m)"))),
    ),
    (
        "verify-limits",
        "--stiffness",
        "signorini --elements 2 --mass lumped --scheme park --stiffness 1e4 --ratio 1",
        All("penalty_stiffness", "10000.0"),
    ),
    ("optimal-ratio", "--engine", "signorini --mass lumped --beta-s 1 --engine dense", All("holds", "true")),
    ("scheme-limits", "--elements", "hunek --elements 1 --mass lumped", All("elements", "3")),
    ("scheme-limits", "--mass", "signorini --elements 2 --mass 0.3", All("gamma", "0.3")),
    (
        "scheme-limits",
        "--penalty-mass",
        "symmetric --elements 2 --mass lumped --penalty-mass diagonalised",
        Refused("diagonalised"),
    ),
    ("scheme-limits", "--theta", "signorini --elements 2 --mass lumped --theta 0", Other(BAR)),
    (
        "scheme-limits",
        "--per-force",
        "signorini --elements 2 --mass lumped --per-force --limit predictor-corrector,park --beta-s 0 --ratio 1",
        Column("cost", &["1.0", "2.0"]),
    ),
    (
        "scheme-limits",
        "--limit",
        "signorini --elements 2 --mass lumped --per-force --limit noh-bathe:0.5 --beta-s 0 --ratio 1",
        Column("parameter", &["0.5"]),
    ),
    (
        "scheme-limits",
        "--beta-s",
        "signorini --elements 2 --mass lumped --per-force --limit park --beta-s 1,2 --ratio 1",
        Column("stiffness_penalty", &["1.0", "2.0"]),
    ),
    (
        "scheme-limits",
        "--stiffness",
        "signorini --elements 2 --mass lumped --per-force --limit park --stiffness 1e4 --ratio 1",
        All("penalty_stiffness", "10000.0"),
    ),
    (
        "mesh-limits",
        "--units",
        "contact --quick --units si",
        Holds(|scratch| assert!(text(scratch, "there/contact.csv").contains("penalty_stiffness"))),
    ),
    (
        "scheme-limits",
        "--ratio",
        "signorini --elements 2 --mass lumped --per-force --limit park --beta-s 1 --ratio 1,inf",
        Column("ratio", &["1.0", "inf"]),
    ),
    ("scheme-limits", "--from", "--from missing.csv", Refused("missing.csv")),
    (
        "contact-impact",
        "--stiffness",
        "signorini --elements 3 --mass lumped --stiffness 1e4 --scheme park",
        All("penalty_stiffness", "10000.0"),
    ),
    (
        "contact-impact",
        "--elements",
        "signorini --elements 3 --mass lumped --beta-s 1 --scheme park",
        Column("steps", &["18"]),
    ),
    (
        "contact-impact",
        "--mass",
        "signorini --elements 4 --mass 0.3,lumped --beta-s 1 --scheme park",
        Column("mass", &["0.3", "lumped"]),
    ),
    (
        "contact-impact",
        "--beta-s",
        "signorini --elements 4 --mass lumped --beta-s 1,1e3 --scheme park",
        Column("stiffness_penalty", &["1.0", "1000.0"]),
    ),
    (
        "contact-impact",
        "--ratio",
        "signorini --elements 4 --mass lumped --beta-s 1 --scheme park --ratio 2,3",
        Column("ratio", &["2.0", "3.0"]),
    ),
    (
        "contact-impact",
        "--scheme",
        "signorini --elements 4 --mass lumped --beta-s 1 --scheme predictor-corrector,park",
        Column("scheme", &["predictor-corrector", "park"]),
    ),
    // T = 0.3 s, h/c0 = 0.025 s: 12 steps at C = 1, 48 at C = 1/4.
    (
        "contact-impact",
        "--relative-courant",
        "signorini --elements 4 --mass lumped --beta-s 1 --scheme park --relative-courant 0.25",
        Column("steps", &["48"]),
    ),
    // T = 0.3 s.
    (
        "contact-impact",
        "--time-step",
        "signorini --elements 4 --mass lumped --beta-s 1 --scheme park --time-step 0.01",
        Column("steps", &["30"]),
    ),
    // At r = 1 and beta_s = 1e9 the predictor-corrector stands C = 1/2: 24 steps at it, 48 at half of it.
    (
        "contact-impact",
        "--fraction",
        "signorini --elements 4 --mass lumped --beta-s 1e9 --scheme predictor-corrector --fraction 0.5",
        Column("steps", &["48"]),
    ),
    (
        "contact-impact",
        "--frame-every",
        "signorini --elements 4 --mass lumped --beta-s 1 --scheme park --frame-every 0",
        Refused("frame-every"),
    ),
    (
        "contact-impact",
        "--theta",
        "signorini --elements 4 --mass lumped --beta-s 1 --scheme park --theta 1",
        Other(IMPACT),
    ),
    (
        "contact-impact",
        "--duration",
        "signorini --elements 4 --mass lumped --beta-s 1 --scheme park --duration 0.1",
        Column("steps", &["8"]),
    ),
    (
        "contact-impact",
        "--stress-at",
        "signorini --elements 4 --mass lumped --beta-s 1 --scheme park --stress-at 0.1",
        Holds(|scratch| assert_eq!(stress_times(scratch), ["0.1"; 4])),
    ),
    (
        "contact-impact",
        "--fields",
        "signorini --elements 4 --mass lumped --beta-s 1 --scheme park --fields",
        Refused("--fields"),
    ),
    (
        "contact-impact",
        "--every",
        "signorini --elements 4 --mass lumped --beta-s 1 --scheme park --every 10",
        Holds(|scratch| {
            let history = text(scratch, "there/signorini-lumped-park-beta1-r1.csv");
            assert_eq!(column(&history, "time"), ["0.0", "0.125", "0.25", "0.30000000000000004"]);
        }),
    ),
    (
        "verify-limits",
        "--elements",
        "hunek --elements 2 --mass lumped --beta-s 1 --ratio 1 --scheme central-difference",
        Column("elements", &["6"]),
    ),
    (
        "verify-limits",
        "--mass",
        "signorini --elements 1 --mass 0.3,lumped --beta-s 1 --ratio 1 --scheme central-difference",
        Column("gamma", &["0.3", "1.0"]),
    ),
    (
        "verify-limits",
        "--beta-s",
        "signorini --elements 1 --mass lumped --beta-s 1,2 --ratio 1 --scheme central-difference",
        Column("stiffness_penalty", &["1.0", "2.0"]),
    ),
    (
        "verify-limits",
        "--ratio",
        "signorini --elements 1 --mass lumped --beta-s 1 --ratio 2,inf --scheme central-difference",
        Column("ratio", &["2.0", "inf"]),
    ),
    (
        "verify-limits",
        "--scheme",
        "signorini --elements 1 --mass lumped --beta-s 1 --ratio 1 --scheme central-difference",
        Column("scheme", &["central-difference"]),
    ),
    (
        "verify-limits",
        "--penalty-mass",
        "symmetric --elements 1 --mass lumped --beta-s 1 --ratio 1 --penalty-mass diagonalised",
        Refused("diagonalised"),
    ),
    (
        "verify-limits",
        "--tolerance",
        "signorini --elements 1 --mass lumped --beta-s 1 --ratio 2 --tolerance 1e-2",
        Other("signorini --elements 1 --mass lumped --beta-s 1 --ratio 2"),
    ),
    (
        "verify-limits",
        "--theta",
        "signorini --elements 1 --mass lumped --beta-s 1 --ratio 1 --scheme park --theta 1",
        Other("signorini --elements 1 --mass lumped --beta-s 1 --ratio 1 --scheme park"),
    ),
    ("verify-limits", "--contact", OPENING, All("contact", "opening")),
    (
        "verify-limits",
        "--fraction",
        "signorini --elements 4 --mass lumped --scheme park --beta-s 1 --ratio 1 --contact opening --fraction 0.25",
        Other(OPENING),
    ),
    (
        "work-precision",
        "--quick",
        "--quick --peers none",
        Holds(|scratch| {
            let records = text(scratch, "there/work-precision.csv");
            assert!(column(&records, "size").iter().all(|size| size.parse::<usize>().unwrap() <= 1000));
        }),
    ),
    ("work-precision", "--peers", "--quick --peers no-python", Refused("--peers")),
    ("step-speed", "--repeats", "--repeats 0", Refused("--repeats")),
    ("map-speed", "--points", "--points 1", Refused("2 to")),
];

pub fn text(scratch: &Scratch, file: &str) -> String {
    String::from_utf8(scratch.read(file)).unwrap()
}

/// A column of a CSV without quoted commas.
pub fn column<'a>(csv: &'a str, name: &str) -> Vec<&'a str> {
    let mut lines = csv.lines();
    let header = lines.next().unwrap_or_else(|| panic!("no records"));
    let at = header.split(',').position(|known| known == name).unwrap_or_else(|| panic!("{name}: {header}"));
    lines.map(|line| line.split(',').nth(at).unwrap()).collect()
}

/// The times of the stress rows of the sample impact.
fn stress_times(scratch: &Scratch) -> Vec<String> {
    let records = text(scratch, "there/signorini-lumped-park-beta1-r1-stress.csv");
    column(&records, "time").into_iter().map(str::to_owned).collect()
}
