//! Extracts the mid-surface of a table of phantoms with known truth, clean and noisy, several
//! seeds each, and prints how good the meshes are, one line each.
//!
//! `cargo run -p phantoms --release --example table -- --help`

use std::error::Error;
use std::fs::{create_dir_all, File};
use std::io::BufWriter;
use std::path::{Path, PathBuf};
use std::time::Instant;

use midsurface::{extract, Grid, Mesh, Method, Options, Quiet, Volume};
use phantoms::{judge, trials, write_ply, write_vti, Frame, Phantom, Trial};

const METHODS: &[(&str, Method)] = &[
    ("zipper", Method::PolylineZipper),
    ("ridge", Method::RidgeSurface),
];

const HELP: &str = "\
Usage: table [OPTION...] [PART OF A NAME...]

Lines end with MISS and what falls short of what a mesh must be, or with `below aim`.

  --method NAME    one of METHODS (default: the last)
  --seeds N        seeds per phantom (default 2)
  --seed N         the first seed (default 1)
  --clean          only without noise
  --noisy          only with noise
  --misses         print only the lines with a MISS
  --edge LENGTH    edge length to aim at, world units (default: automatic)
  --threads N      worker threads (default: one a core)
  --write FOLDER   write each volume (.vti) and mesh (.ply) there
";

struct Arguments {
    method: Method,
    seeds: std::ops::Range<u64>,
    noise: Vec<bool>,
    only_misses: bool,
    edge_length: f64,
    threads: usize,
    folder: Option<PathBuf>,
    names: Vec<String>,
}

fn main() -> Result<(), Box<dyn Error>> {
    let Some(arguments) = arguments()? else {
        let names: Vec<&str> = METHODS.iter().map(|(name, _)| *name).collect();
        print!("{}", HELP.replace("METHODS", &names.join(", ")));
        return Ok(());
    };
    let wanted = |trial: &Trial| {
        let names = &arguments.names;
        names.is_empty() || names.iter().any(|part| trial.name.contains(part.as_str()))
    };
    let (mut runs, mut missed, mut at_aim, mut seconds) = (0, 0, 0, 0.0);
    for trial in trials().iter().filter(|trial| wanted(trial)) {
        for &noisy in &arguments.noise {
            for seed in arguments.seeds.clone() {
                let outcome = run(trial, seed, noisy, &arguments)?;
                runs += 1;
                missed += usize::from(outcome.missed);
                at_aim += usize::from(outcome.at_aim);
                seconds += outcome.seconds;
            }
        }
    }
    println!("{runs} meshes in {seconds:.1} s: {missed} MISS, {at_aim} at the aim in everything");
    Ok(())
}

fn arguments() -> Result<Option<Arguments>, Box<dyn Error>> {
    let mut found = Arguments {
        method: METHODS[METHODS.len() - 1].1,
        seeds: 1..3,
        noise: vec![false, true],
        only_misses: false,
        edge_length: 0.0,
        threads: 0,
        folder: None,
        names: Vec::new(),
    };
    let (mut first, mut count) = (1, 2);
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let mut value = || words.next().ok_or(format!("{word} needs a value"));
        match word.as_str() {
            "--help" => return Ok(None),
            "--method" => {
                let name = value()?;
                let method = METHODS.iter().find(|(n, _)| *n == name);
                found.method = method.ok_or(format!("no method is called {name}"))?.1;
            }
            "--seeds" => count = value()?.parse()?,
            "--seed" => first = value()?.parse()?,
            "--clean" => found.noise = vec![false],
            "--noisy" => found.noise = vec![true],
            "--misses" => found.only_misses = true,
            "--edge" => found.edge_length = value()?.parse()?,
            "--threads" => found.threads = value()?.parse()?,
            "--write" => found.folder = Some(value()?.into()),
            _ if word.starts_with("--") => return Err(format!("unknown option {word}").into()),
            _ => found.names.push(word),
        }
    }
    found.seeds = first..first + count;
    Ok(Some(found))
}

struct Outcome {
    missed: bool,
    at_aim: bool,
    seconds: f64,
}

fn run(
    trial: &Trial,
    seed: u64,
    noisy: bool,
    arguments: &Arguments,
) -> Result<Outcome, Box<dyn Error>> {
    let phantom = trial.phantom(seed, noisy);
    let volume = Volume::new(&phantom.labels, grid(&phantom.frame))?;
    let options = Options {
        method: arguments.method,
        threads: arguments.threads,
        edge_length: arguments.edge_length,
        ..Options::default()
    };
    let start = Instant::now();
    let mesh = extract(&volume, &options, &mut Quiet::default())?;
    let seconds = start.elapsed().as_secs_f64();
    let report = judge(&mesh.points, &mesh.triangles, &phantom);
    let (missed, below_aim) = trial.verdict(&report, &phantom, noisy);
    let noise = if noisy { "noisy" } else { "clean" };
    if !(arguments.only_misses && missed.is_empty()) {
        print!(
            "{:30} {noise} {seed:3} {seconds:5.2} s {report}",
            trial.name
        );
        if !missed.is_empty() {
            print!(" | MISS {}", missed.join(", "));
        }
        if !below_aim.is_empty() {
            print!(" | below aim: {}", below_aim.join(", "));
        }
        println!();
    }
    if let Some(folder) = &arguments.folder {
        let name = format!("{}-{noise}-{seed}", trial.name.replace([' ', ','], "_"));
        write(folder, &name, &phantom, &mesh)?;
    }
    Ok(Outcome {
        missed: !missed.is_empty(),
        at_aim: missed.is_empty() && below_aim.is_empty(),
        seconds,
    })
}

fn grid(frame: &Frame) -> Grid {
    Grid {
        dimensions: frame.dimensions,
        extent_start: frame.extent_start,
        spacing: frame.spacing,
        origin: frame.origin,
        direction: frame.direction,
    }
}

fn write(folder: &Path, name: &str, phantom: &Phantom, mesh: &Mesh) -> std::io::Result<()> {
    create_dir_all(folder)?;
    let create = |ending: &str| File::create(folder.join(format!("{name}.{ending}")));
    write_vti(
        &mut BufWriter::new(create("vti")?),
        &phantom.frame,
        &phantom.labels,
    )?;
    write_ply(
        &mut BufWriter::new(create("ply")?),
        &mesh.points,
        &mesh.triangles,
    )
}
