//! Extracts the mid-surface of a table of phantoms and prints how good each is, one line each.
//!
//! `cargo run -p phantoms --release --example judge [PART OF A NAME]`

use std::time::Instant;

use midsurface::{extract, Grid, Options, Quiet, Volume};
use phantoms::*;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let filter = std::env::args().nth(1).unwrap_or_default();
    for (name, make) in table() {
        if name.contains(&filter) {
            let phantom = make();
            println!("{name:32} {}", measure(&phantom)?);
        }
    }
    Ok(())
}

fn measure(phantom: &Phantom) -> Result<String, midsurface::Error> {
    let frame = &phantom.frame;
    let grid = Grid {
        dimensions: frame.dimensions,
        extent_start: frame.extent_start,
        spacing: frame.spacing,
        origin: frame.origin,
        direction: frame.direction,
    };
    let volume = Volume::new(&phantom.labels, grid)?;
    let mut observer = Quiet::default();
    let start = Instant::now();
    let mesh = extract(&volume, &Options::default(), &mut observer)?;
    let seconds = start.elapsed().as_secs_f64();
    let report = judge(&mesh.points, &mesh.triangles, phantom);
    let verdict = match phantom.topology {
        _ if !report.is_clean() => "FAULTY",
        Some(expected) if expected != report.connectivity.topology => "TOPOLOGY",
        _ => "",
    };
    Ok(format!("{seconds:5.2} s {report} {verdict}"))
}

type Row = (String, Box<dyn Fn() -> Phantom>);

fn table() -> Vec<Row> {
    let mut rows: Vec<Row> = Vec::new();
    let mut add = |name: &str, make: Box<dyn Fn() -> Phantom>| rows.push((name.to_owned(), make));
    let cube = |n: usize| Frame::new([n; 3]);
    let tall = || Frame::new([80, 80, 60]);

    add(
        "tube R=25, 6 thick",
        Box::new(move || tube(tall(), 25.0, 6.0)),
    );
    // An odd size: no voxel centre lies exactly on a face, where rounding would shift the label.
    add(
        "tube R=25, 3 thick",
        Box::new(move || tube(Frame::new([81, 81, 60]), 25.0, 3.0)),
    );
    add(
        "tube R=25, 6 thick, noise 5 %",
        Box::new(move || tube(tall(), 25.0, 6.0).with_noise(0.05, 7)),
    );
    for thickness in [2.0, 3.0, 6.0, 8.0] {
        for tilt in [0.0, 10.0, 20.0, 30.0, 40.0, 45.0] {
            let make = move || {
                let frame = cube(64);
                let hole = hole_in_the_middle(&frame, 12.0);
                sheet(frame, leaning(tilt, 33.0), thickness, &[hole])
            };
            add(
                &format!("sheet {tilt} deg, {thickness} thick, hole"),
                Box::new(make),
            );
        }
    }
    let noisy = move || {
        let frame = cube(64);
        let hole = hole_in_the_middle(&frame, 12.0);
        sheet(frame, leaning(30.0, 33.0), 6.0, &[hole]).with_noise(0.05, 7)
    };
    add("sheet 30 deg, 6 thick, noise 5 %", Box::new(noisy));
    for spacing in [[1.0, 1.0, 2.0], [2.0, 1.0, 1.0]] {
        let dimensions = spacing.map(|s: f64| (64.0 / s) as usize);
        let frame = Frame::with_spacing(dimensions, spacing);
        let make = move || {
            let hole = hole_in_the_middle(&frame, 12.0);
            sheet(frame.clone(), leaning(20.0, 33.0), 6.0, &[hole])
        };
        add(
            &format!("sheet 20 deg, spacing {spacing:?}"),
            Box::new(make),
        );
    }
    let thin = move || sheet(cube(64), leaning(15.0, 33.0), 1.4, &[]);
    add("sheet 15 deg, 1 voxel thin", Box::new(thin));
    let constant = |t| Thickness::Constant(t);
    add(
        "disk 30 deg",
        Box::new(move || disk(cube(64), leaning(30.0, 33.0), 24.0, 0.0, constant(6.0))),
    );
    add(
        "disk 30 deg, hole",
        Box::new(move || disk(cube(64), leaning(30.0, 33.0), 24.0, 9.0, constant(6.0))),
    );
    add(
        "disk 20 deg, 3 to 12 thick",
        Box::new(move || wedge_disk(cube(64), leaning(20.0, 33.0), 24.0, 3.0, 12.0)),
    );
    add(
        "two sheets 20 deg, gap 2",
        Box::new(move || two_sheets(cube(64), leaning(20.0, 33.0), 4.0, 2.0, [1, 1])),
    );
    add(
        "two sheets 20 deg, touching",
        Box::new(move || two_sheets(cube(64), leaning(20.0, 33.0), 4.0, 0.0, [1, 2])),
    );
    add(
        "sphere R=20, 4 thick",
        Box::new(move || sphere(cube(64), 20.0, 4.0)),
    );
    add(
        "nested spheres",
        Box::new(move || nested_spheres(cube(64), &[12.0, 24.0], 4.0)),
    );
    add(
        "cap",
        Box::new(move || cap(cube(64), 20.0, [1.0, 0.3, 0.0], 100.0, 4.0)),
    );
    add(
        "torus",
        Box::new(move || torus(cube(80), [0.0, 0.0, 1.0], 22.0, 10.0, 4.0)),
    );
    add(
        "torus, lying",
        Box::new(move || torus(cube(80), [1.0, 0.2, 0.0], 22.0, 10.0, 4.0)),
    );
    add("gyroid", Box::new(move || gyroid(cube(64), 40.0, 4.0)));
    add(
        "junction",
        Box::new(move || junction(cube(64), leaning(5.0, 33.0), 4.0)),
    );
    rows
}
