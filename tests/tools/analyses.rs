//! The other tools as their users meet them: records as promised, checks that hold, wrong input refused.

// A helper that cannot go on fails its test.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::process::{Command, Output};

#[path = "common/tool.rs"]
mod tool;

use tool::Scratch;

const OPTIMAL_RATIO: &str = env!("CARGO_BIN_EXE_optimal-ratio");
const CONTACT_IMPACT: &str = env!("CARGO_BIN_EXE_contact-impact");
const VERIFY_LIMITS: &str = env!("CARGO_BIN_EXE_verify-limits");

fn run(tool: &str, directory: &Scratch, arguments: &str) -> Output {
    Command::new(tool).args(arguments.split_whitespace()).current_dir(directory.path()).output().unwrap()
}

/// The rows of a run that must end with exit status 0, as columns by name.
fn rows(tool: &str, directory: &Scratch, arguments: &str) -> (Vec<String>, Vec<Vec<String>>) {
    let out = run(tool, directory, arguments);
    assert_eq!(out.status.code(), Some(0), "{arguments}: {}", String::from_utf8_lossy(&out.stderr));
    let text = String::from_utf8(out.stdout).unwrap();
    let fields = |line: &str| line.split(',').map(str::to_owned).collect::<Vec<_>>();
    let mut lines = text.lines();
    (fields(lines.next().unwrap()), lines.map(fields).collect())
}

fn number(header: &[String], row: &[String], name: &str) -> f64 {
    let column = header.iter().position(|known| known == name).unwrap();
    row[column].parse().unwrap_or_else(|_| panic!("{name} is {:?}", row[column]))
}

#[test]
fn the_optimal_ratio_is_one_and_enclosed() {
    let directory = Scratch::new("optimal");
    let (header, rows) = rows(OPTIMAL_RATIO, &directory, "--beta-s log:1e-3:1e12:6 --stdout csv -q");
    let promised = "scene,mass,gamma,elements,limit,stiffness_penalty,optimal_ratio,lower,upper,holds";
    let later = ",contact_free_step,penalty_stiffness,penalty_mass";
    assert_eq!(header.join(","), promised.to_owned() + later);
    assert_eq!(rows.len(), 3 * 3 * 6);
    for row in &rows {
        assert!(number(&header, row, "lower") <= 1.0 && 1.0 <= number(&header, row, "upper"), "{row:?}");
        assert_eq!(row[9], "true");
    }
    assert!(std::fs::read_dir(directory.path()).unwrap().next().is_none(), "--stdout wrote a file");
}

#[test]
fn the_governing_bar_is_named() {
    let directory = Scratch::new("governs");
    let bar = |modulus: f64| {
        format!(
            "[[bar]]\nlength = 1.0\nelements = 4\nyoungs_modulus = {modulus}\ndensity = 1.0\narea = 1.0\n"
        )
    };
    std::fs::write(directory.path().join("two.toml"), format!("name = \"two\"\n{}{}", bar(1.0), bar(9.0)))
        .unwrap();
    let out = run(OPTIMAL_RATIO, &directory, "two.toml --mass lumped --beta-s 1e4 --out out");
    assert_eq!(out.status.code(), Some(0));
    assert!(String::from_utf8_lossy(&out.stderr).contains("the elements of bar 2"));
}

/// Force error and penetration of the stiff Signorini contact: the figures of the paper's problem.
#[test]
fn an_impact_is_summed_up() {
    let directory = Scratch::new("impact");
    let arguments =
        "signorini --mass lumped --beta-s 1e4,1e12 --scheme predictor-corrector,park --stdout csv -q";
    let (header, rows) = rows(CONTACT_IMPACT, &directory, arguments);
    let promised = "scene,mass,scheme,stiffness_penalty,ratio,relative_courant,force_error,steady_relative_gap,\
                    energy_ratio,switches";
    assert!(header.join(",").starts_with(promised), "{header:?}");
    assert_eq!(rows.len(), 4);
    for row in &rows {
        assert!(number(&header, row, "force_error") <= 0.05, "{row:?}");
        assert!(number(&header, row, "energy_ratio") < 1.0, "{row:?}");
        let beta_s = number(&header, row, "stiffness_penalty");
        if row[2] == "predictor-corrector" {
            let gap = number(&header, row, "steady_relative_gap") * beta_s;
            assert!((gap / 1e-3 - 1.0).abs() < 0.005, "{row:?}");
        }
    }
}

#[test]
fn every_contact_has_its_history() {
    let directory = Scratch::new("three");
    let bar = "[[bar]]\nlength = 1.0\nelements = 5\nyoungs_modulus = 1.0\ndensity = 1.0\narea = 1.0\nvelocity = 1.0\n";
    let scene = format!(
        "name = \"three\"\n{bar}{}{}[impact]\nduration = 1.0\n",
        bar,
        bar.replace("velocity = 1.0", "")
    );
    std::fs::write(directory.path().join("three.toml"), scene).unwrap();
    let arguments = "three.toml --mass lumped --beta-s 10 --scheme park --out out --format csv,svg --theta 0.5 \
                     --relative-courant 0.4 --duration 2 --stress-at 1 --ratio 1 --threads 1";
    let out = run(CONTACT_IMPACT, &directory, arguments);
    assert_eq!(out.status.code(), Some(0), "{}", String::from_utf8_lossy(&out.stderr));
    let read = |name: &str| std::fs::read_to_string(directory.path().join("out").join(name)).unwrap();
    let header = "time,contact_force,relative_gap,kinetic_energy,strain_energy,contact_work,penalty_energy,body_work,loss";
    for name in ["three-lumped-park-beta10-r1.csv", "three-lumped-park-beta10-r1-contact2.csv"] {
        assert_eq!(read(name).lines().next().unwrap(), header);
    }
    assert!(read("summary.csv").contains("finished"));
    // Each contact has figures of its own; energy and stress belong to the bars.
    for name in ["three-force-lumped", "three-gap-lumped"] {
        assert_ne!(read(&format!("{name}.svg")), read(&format!("{name}-contact2.svg")));
    }
    assert!(!directory.path().join("out/three-energy-lumped-contact2.svg").exists());
}

/// Beyond its limit a run blows up: that is a row and exit status 1, not a crash.
#[test]
fn a_run_that_blows_up_is_a_row() {
    let directory = Scratch::new("blow-up");
    let arguments = "signorini --mass lumped --beta-s 1e4 --relative-courant 1.5 --stdout csv -q";
    let out = run(CONTACT_IMPACT, &directory, arguments);
    assert_eq!(out.status.code(), Some(1));
    let text = String::from_utf8(out.stdout).unwrap();
    assert_eq!(text.lines().count(), 4);
    // No force error, no steady gap, no energy ratio.
    assert!(
        text.lines().skip(1).all(|line| line.contains("blew up by step") && line.contains(",1.5,,,,")),
        "{text}"
    );
}

#[test]
fn stepping_confirms_a_few_limits() {
    let directory = Scratch::new("verify");
    let arguments =
        "--mass lumped,consistent --beta-s 0,3,1e12 --ratio 1,3,inf --tolerance 1e-4 --stdout csv -q";
    let (header, rows) = rows(VERIFY_LIMITS, &directory, arguments);
    let promised = "scene,mass,gamma,elements,scheme,contact,stiffness_penalty,ratio,predicted,stable_at,unstable_at,steps";
    assert!(header.join(",").starts_with(promised), "{header:?}");
    let later = "agrees,predicted_growth,steps_needed,islands,predicted_step,stable_step,unstable_step,penalty_stiffness,penalty_mass";
    assert!(header.join(",").ends_with(later), "{header:?}");
    assert_eq!(rows.len(), 3 * 2 * 2 * 9);
    let agrees = header.iter().position(|name| name == "agrees").unwrap();
    // The pure penalty of beta_s = 1e12: the predictor-corrector grows too slowly for any run, and the row says so.
    let (judged, unseen): (Vec<_>, Vec<_>) = rows.iter().partition(|row| row[agrees] == "true");
    assert_eq!(unseen.len(), 4);
    for row in unseen {
        assert_eq!(
            (row[agrees].as_str(), row[4].as_str(), row[7].as_str()),
            ("", "predictor-corrector", "inf")
        );
        assert!(number(&header, row, "predicted_growth") < 1e-6, "{row:?}");
        assert!(number(&header, row, "steps_needed") > 6e6, "{row:?}");
        assert!(number(&header, row, "stable_at") >= number(&header, row, "predicted"), "{row:?}");
    }
    for row in judged {
        let (low, high) = (number(&header, row, "stable_at"), number(&header, row, "unstable_at"));
        let predicted = number(&header, row, "predicted");
        assert!(low * (1.0 - 1e-4) <= predicted && predicted <= high * (1.0 + 1e-4), "{row:?}");
    }
}

#[test]
fn results_do_not_depend_on_the_number_of_threads() {
    let directory = Scratch::new("threads");
    let tools = [
        (OPTIMAL_RATIO, "hunek --mass lumped --beta-s 1,1e6"),
        (CONTACT_IMPACT, "hunek --mass averaged --beta-s 1e6"),
        (VERIFY_LIMITS, "--mass lumped --beta-s 1,2 --tolerance 1e-3"),
        (
            VERIFY_LIMITS,
            "hunek --contact opening --elements 8 --mass averaged --beta-s 1e4 --fraction 0.4,0.8",
        ),
    ];
    for (tool, arguments) in tools {
        let of = |threads: u32| {
            run(tool, &directory, &format!("{arguments} --stdout json -q --threads {threads}"))
        };
        let (one, two) = (of(1), of(2));
        assert_eq!(one.status.code(), Some(0), "{}", String::from_utf8_lossy(&one.stderr));
        assert!(!one.stdout.is_empty() && one.stdout == two.stdout, "{arguments}");
    }
}

#[test]
fn wrong_input_is_refused_before_anything_is_written() {
    let directory = Scratch::new("refused");
    // Scenes for this test lie elsewhere, so that the folder stays empty.
    let scenes = Scratch::new("refused-scenes");
    let bar = "[[bar]]\nlength = 1.0\nelements = 5\nyoungs_modulus = 1.0\ndensity = 1.0\narea = 1.0\n";
    let alone = scenes.path().join("alone.toml");
    std::fs::write(&alone, format!("name = \"alone\"\n{bar}[impact]\nduration = 1.0\n")).unwrap();
    let alone = alone.to_str().unwrap();
    let wrong = [
        (CONTACT_IMPACT, alone, "a scene with at least one contact"),
        (OPTIMAL_RATIO, "signorini --beta-s -1", "--beta-s"),
        (OPTIMAL_RATIO, "signorini --elements 0", "--elements"),
        (CONTACT_IMPACT, "signorini --relative-courant 0", "--relative-courant"),
        (CONTACT_IMPACT, "signorini --relative-courant nan", "--relative-courant"),
        (CONTACT_IMPACT, "signorini --relative-courant 1e-12", "steps"),
        (CONTACT_IMPACT, "signorini --duration nan", "--duration"),
        (CONTACT_IMPACT, "signorini --theta 2", "--theta"),
        (CONTACT_IMPACT, "signorini --scheme newmark", "scheme"),
        (CONTACT_IMPACT, "symmetric --penalty-mass diagonalised", "penalty-mass"),
        (CONTACT_IMPACT, "signorini --stress-at 0.31", "--stress-at: 0.31"),
        (CONTACT_IMPACT, "signorini --stress-at -1", "--stress-at: -1"),
        (CONTACT_IMPACT, "signorini --duration 0.1 --stress-at 0.2", "from 0 to 1e-1"),
        (CONTACT_IMPACT, "signorini --every 0", "--every"),
        (CONTACT_IMPACT, "signorini --duration 1e9", "--duration"),
        (CONTACT_IMPACT, "signorini signorini", "a second run that writes signorini-lumped"),
        (CONTACT_IMPACT, "signorini --scheme park,park", "a second run that writes"),
        (OPTIMAL_RATIO, "signorini signorini", "a second run that writes signorini"),
        (VERIFY_LIMITS, "signorini --tolerance 2", "tolerance"),
        (VERIFY_LIMITS, "signorini --ratio 0", "--ratio"),
        (VERIFY_LIMITS, "signorini --contact ajar", "--contact"),
        (VERIFY_LIMITS, "signorini --contact opening --fraction 0.5,1", "--fraction"),
        (VERIFY_LIMITS, "signorini --contact opening --fraction 0", "--fraction"),
        (VERIFY_LIMITS, "signorini --contact opening --tolerance 1e-3", "--tolerance"),
        (VERIFY_LIMITS, "signorini --fraction 0.5", "--fraction"),
        (VERIFY_LIMITS, "signorini signorini --contact opening", "SCENE"),
        (VERIFY_LIMITS, "hunek --contact opening --penalty-mass diagonalised", "mass penalty"),
        (VERIFY_LIMITS, "signorini --scheme central-difference --theta 1", "--theta"),
        (VERIFY_LIMITS, "signorini --scheme park --theta 2", "--theta"),
        (VERIFY_LIMITS, "signorini signorini", "signorini"),
        (VERIFY_LIMITS, "symmetric --penalty-mass diagonalised", "diagonalised"),
    ];
    for (tool, arguments, named) in wrong {
        let out = run(tool, &directory, arguments);
        let message = String::from_utf8_lossy(&out.stderr).into_owned();
        assert_eq!(out.status.code(), Some(2), "{arguments}: {message}");
        assert!(message.contains(named) && !message.contains("panicked"), "{arguments}: {message}");
        assert!(std::fs::read_dir(directory.path()).unwrap().next().is_none(), "{arguments} wrote a file");
    }
}

#[test]
fn another_impact_leaves_the_files_of_the_usual_one() {
    let directory = Scratch::new("impact-folder");
    let run = |more: &str| {
        let words = format!("signorini --elements 4 --mass lumped --format csv --quiet {more}");
        let mut program = Command::new(CONTACT_IMPACT);
        program.current_dir(directory.path()).args(words.split_whitespace());
        assert!(program.status().unwrap().success(), "{more}");
    };
    run("--scheme park --beta-s 1");
    run("--scheme park --beta-s 1 --ratio 0.25");
    run("--scheme park --stiffness 1e4");
    let mut folders: Vec<String> = std::fs::read_dir(directory.path().join("figures/contact-impact"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    folders.sort();
    assert_eq!(folders, ["n4-beta1-park", "n4-beta1-r0.25-park", "n4-s1e4-park"]);
}
