//! Extracts the mid-surfaces of random tubes and leaning sheets with a hole by the polyline zipper,
//! and prints how many fall short of what they must be, and which.
//!
//! `cargo run -p phantoms --release --example upright -- [NUMBER OF EACH] [FIRST SEED] [all]`

use midsurface::{extract, Grid, Method, Options, Quiet, Volume};
use phantoms::{judge, leaning_sheet, upright_tube, Phantom, Report};

/// The largest distance to the truth, root mean square, voxels.
const MOST: f64 = 0.1;

type Kind = (&'static str, fn(u64) -> Phantom);

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut words: Vec<String> = std::env::args().skip(1).collect();
    let all = words.iter().any(|word| word == "all");
    words.retain(|word| word != "all");
    let number = |at: usize, usual| words.get(at).map_or(Ok(usual), |word| word.parse());
    let (count, first) = (number(0, 100)?, number(1, 1)?);
    let kinds: [Kind; 2] = [("tubes", upright_tube), ("sheets", leaning_sheet)];
    for (name, make) in kinds {
        let mut distances = Vec::new();
        let mut short = 0;
        for seed in first..first + count {
            let phantom = make(seed);
            let report = report(&phantom)?;
            let is_short = falls_short(&report, &phantom);
            short += usize::from(is_short);
            if is_short || all {
                println!("{seed:4} {}: {report}", phantom.name);
            }
            distances.push(report.rms);
        }
        distances.sort_by(f64::total_cmp);
        let at = |share: f64| distances[((distances.len() - 1) as f64 * share) as usize];
        println!(
            "{count} {name}: {short} fall short; rms {:.3} in the middle, {:.3} at 95 %, at most {:.3}",
            at(0.5),
            at(0.95),
            at(1.0)
        );
    }
    Ok(())
}

fn report(phantom: &Phantom) -> Result<Report, midsurface::Error> {
    let grid = Grid::new(phantom.frame.dimensions);
    let options = Options {
        method: Method::PolylineZipper,
        ..Options::default()
    };
    let volume = Volume::new(&phantom.labels, grid)?;
    let mesh = extract(&volume, &options, &mut Quiet::default())?;
    Ok(judge(&mesh.points, &mesh.triangles, phantom))
}

fn falls_short(report: &Report, phantom: &Phantom) -> bool {
    let is_right = report.rms <= MOST
        && report.covered_within_1 >= 1.0
        && Some(report.connectivity.topology) == phantom.topology
        && report.faults().iter().all(|(count, _)| *count == 0);
    !is_right
}
