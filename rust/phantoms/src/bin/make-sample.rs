//! Writes a label volume: a mitochondrion, or a phantom by name.

use std::error::Error;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;
use std::process::ExitCode;

use phantoms::*;

const USAGE: &str =
    "usage: make-sample FILE.vti|FILE.mrc [what] [--size X Y Z] [--noise SHARE] [--seed N]

Writes a label volume (8 bits).
  what     mitochondrion (default: label 1 outer, label 2 inner membrane), or a phantom with
           label 1: tube, sheet, touching-sheets (labels 1 and 2), sphere, torus, gyroid
  --size   number of voxels along x, y, z (default 224 128 64; each at least 32)
  --noise  share of the voxels at the membranes' faces that are flipped (default 0.03)
  --seed   another number, another noise and other folds (default 1)";

struct Request {
    file: String,
    what: String,
    size: [usize; 3],
    noise: f64,
    seed: u64,
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if arguments.iter().any(|a| a == "-h" || a == "--help") {
        println!("{USAGE}");
        return ExitCode::SUCCESS;
    }
    let request = match parse(arguments) {
        Ok(request) => request,
        Err(error) => {
            eprintln!("make-sample: {error}\n{USAGE}");
            return ExitCode::from(2);
        }
    };
    match write(&request) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("make-sample: {}: {error}", request.file);
            ExitCode::FAILURE
        }
    }
}

fn parse(arguments: Vec<String>) -> Result<Request, Box<dyn Error>> {
    let mut request = Request {
        file: String::new(),
        what: "mitochondrion".to_owned(),
        size: [224, 128, 64],
        noise: 0.03,
        seed: 1,
    };
    let mut names = Vec::new();
    let mut rest = arguments.into_iter();
    while let Some(argument) = rest.next() {
        let mut value = || {
            rest.next()
                .ok_or_else(|| format!("{argument} needs a value"))
        };
        match argument.as_str() {
            "--size" => {
                for n in &mut request.size {
                    *n = value()?.parse()?;
                }
            }
            "--noise" => request.noise = value()?.parse()?,
            "--seed" => request.seed = value()?.parse()?,
            _ => names.push(argument),
        }
    }
    let mut names = names.into_iter();
    request.file = names.next().ok_or("no file to write was named")?;
    if let Some(what) = names.next() {
        request.what = what;
    }
    if request.size.iter().any(|&n| n < 32) {
        return Err("each size must be at least 32".into());
    }
    match names.next() {
        Some(extra) => Err(format!("{extra:?} is not understood").into()),
        None => Ok(request),
    }
}

fn write(request: &Request) -> Result<(), Box<dyn Error>> {
    let frame = Frame::new(request.size);
    let labels = labels(request, &frame)?;
    let extension = Path::new(&request.file).extension();
    let mut out = Vec::new();
    match extension.and_then(|e| e.to_str()) {
        Some("vti") => write_vti(&mut out, &frame, &labels)?,
        Some("mrc") => write_mrc(&mut out, &frame, &labels)?,
        _ => return Err("the file's name must end in .vti or .mrc".into()),
    }
    let mut file = BufWriter::new(File::create(&request.file)?);
    file.write_all(&out)?;
    Ok(file.flush()?)
}

fn labels(request: &Request, frame: &Frame) -> Result<Vec<u8>, Box<dyn Error>> {
    let frame = frame.clone();
    let least = request.size.into_iter().min().unwrap_or(0) as f64;
    let phantom = match request.what.as_str() {
        "mitochondrion" => return Ok(mitochondrion(request.size, request.noise, request.seed)),
        "tube" => tube(frame, 0.35 * least, 5.0),
        "sheet" => {
            let hole = hole_in_the_middle(&frame, 0.2 * least);
            sheet(frame, leaning(30.0, 33.0), 5.0, &[hole])
        }
        "touching-sheets" => two_sheets(frame, leaning(20.0, 33.0), 5.0, 0.0, [1, 2]),
        "sphere" => sphere(frame, 0.35 * least, 4.0),
        "torus" => torus(frame, [0.0, 0.0, 1.0], 0.3 * least, 0.14 * least, 3.0),
        "gyroid" => gyroid(frame, 0.6 * least, 4.0),
        other => return Err(format!("there is no phantom called {other:?}").into()),
    };
    Ok(phantom.with_noise(request.noise, request.seed).labels)
}
