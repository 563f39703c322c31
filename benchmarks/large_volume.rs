//! A volume of 2048 × 2048 × 1024 bytes with about 30 million labelled voxels, and two smaller ones as
//! densely filled: seconds per million labelled voxels, and memory beyond the volume.
//!
//!     cargo run -p phantoms --release --example large_volume
//!
//! The volumes are full of vesicles, sheets and tubes, each a component of its own; the method is
//! the ridge surface with two threads. Needs Linux and 8 GB. Seconds are both those of the clock and
//! those of the processors, since only the latter mean something on a busy machine. Fails where
//! memory, or the rise of the time for a voxel from one size to the next, is beyond what the project
//! promises.

use std::time::Instant;

use midsurface::{extract, Grid, Mesh, Options, Quiet, Volume};
use phantoms::Dice;

/// Numbers of voxels along x, y, z; the last is the volume that the promise is about.
const SIZES: [[usize; 3]; 3] = [[1024, 512, 512], [1024, 1024, 512], [2048, 2048, 1024]];
/// Each object has a cube of the volume to itself, so many voxels wide, and keeps off its walls.
const CELL: usize = 160;
const ROOM: f64 = 76.0;
/// So far, in voxels, an object's faces are rough.
const ROUGHNESS: f64 = 0.4;

/// Most megabytes beyond the volume, and most that the time for a voxel may rise by.
const MEMORY: f64 = 2000.0;
const RISE: f64 = 1.2;

#[derive(Clone, Copy)]
enum Shape {
    Vesicle,
    Sheet,
    Tube,
}

/// A closed sphere, a bent round sheet or an open tube, round the origin.
struct Object {
    shape: Shape,
    radius: f64,
    half_thickness: f64,
    /// A rotation: the object's axes in the volume's.
    axes: [[f64; 3]; 3],
}

impl Object {
    fn new(dice: &mut Dice) -> Self {
        let shape = dice.one_of(&[Shape::Vesicle, Shape::Sheet, Shape::Tube]);
        let (least, most) = match shape {
            Shape::Vesicle => (12.0, 38.0),
            Shape::Sheet => (25.0, 66.0),
            Shape::Tube => (7.0, 16.0),
        };
        Self {
            shape,
            radius: dice.between(least, most),
            half_thickness: dice.between(1.4, 3.0),
            axes: dice.rotation(),
        }
    }

    /// Labels of vesicles, sheets and tubes.
    fn label(&self) -> u8 {
        self.shape as u8 + 1
    }

    /// Distance of a point from the object's mid-surface, or more; infinite beyond its rims.
    fn distance(&self, p: [f64; 3]) -> f64 {
        let along = |axis: [f64; 3]| axis[0] * p[0] + axis[1] * p[1] + axis[2] * p[2];
        let [x, y, z] = self.axes.map(along);
        let (distance, is_beyond) = match self.shape {
            Shape::Vesicle => (x.hypot(y).hypot(z) - self.radius, false),
            Shape::Sheet => {
                // A piece of a sphere.
                let bend = 120.0;
                (x.hypot(y).hypot(z - bend) - bend, x.hypot(y) > self.radius)
            }
            Shape::Tube => (x.hypot(y) - self.radius, z.abs() > 60.0),
        };
        if is_beyond || z.abs() > ROOM {
            f64::INFINITY
        } else {
            distance.abs()
        }
    }

    /// Half the width of a cube that holds the object.
    fn reach(&self) -> usize {
        let reach = match self.shape {
            Shape::Vesicle => self.radius + 4.0,
            _ => ROOM,
        };
        reach.ceil() as usize
    }
}

/// A volume full of objects; their number, and that of their voxels.
fn volume(dimensions: [usize; 3]) -> (Vec<u8>, usize, usize) {
    let mut labels = vec![0u8; dimensions.iter().product()];
    let cells = dimensions.map(|n| n / CELL);
    let mut voxels = 0;
    let count = cells.iter().product();
    for cell in 0..count {
        let at = [
            cell % cells[0],
            cell / cells[0] % cells[1],
            cell / cells[0] / cells[1],
        ];
        let centre = at.map(|place| place * CELL + CELL / 2);
        let mut dice = Dice::new("large volume", cell as u64);
        voxels += draw(
            &Object::new(&mut dice),
            centre,
            dimensions,
            &mut labels,
            &mut dice,
        );
    }
    (labels, count, voxels)
}

/// Draws an object and tells how many voxels it has.
fn draw(
    object: &Object,
    centre: [usize; 3],
    dimensions: [usize; 3],
    labels: &mut [u8],
    dice: &mut Dice,
) -> usize {
    let reach = object.reach();
    let [xs, ys, zs] = centre.map(|c| c - reach..c + reach);
    let mut voxels = 0;
    for z in zs {
        for y in ys.clone() {
            let row = (z * dimensions[1] + y) * dimensions[0];
            for x in xs.clone() {
                let p = [x, y, z];
                let from_centre = std::array::from_fn(|a| p[a] as f64 - centre[a] as f64 + 0.3);
                let beyond = object.distance(from_centre) - object.half_thickness;
                // Chance decides near the faces only, and most voxels are far.
                if beyond < ROUGHNESS && beyond < dice.between(-ROUGHNESS, ROUGHNESS) {
                    labels[row + x] = object.label();
                    voxels += 1;
                }
            }
        }
    }
    voxels
}

/// A field of /proc/self/status in MB.
fn memory(field: &str) -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").expect("Linux");
    let line = status.lines().find(|line| line.starts_with(field));
    let kilobytes = line.and_then(|line| line.split_whitespace().nth(1)?.parse::<f64>().ok());
    kilobytes.expect("a number of kB") / 1000.0
}

/// Seconds that the process has had of the processors.
fn processor_seconds() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").expect("Linux");
    // After the program's name in brackets; the 12th and 13th are ticks of 10 ms.
    let fields = stat.rsplit(')').next().unwrap_or("").split_whitespace();
    let ticks: f64 = fields
        .skip(11)
        .take(2)
        .map(|t| t.parse::<f64>().expect("ticks"))
        .sum();
    ticks / 100.0
}

/// What a run takes: seconds by the clock and of the processors, and MB beyond the volume.
fn measure(labels: &[u8], dimensions: [usize; 3]) -> ([f64; 3], Mesh) {
    let volume = Volume::new(labels, Grid::new(dimensions)).expect("a sound volume");
    let options = Options {
        threads: 2,
        ..Options::default()
    };
    std::fs::write("/proc/self/clear_refs", "5").expect("Linux");
    let before = memory("VmRSS");
    let (clock, processor) = (Instant::now(), processor_seconds());
    let mesh = extract(&volume, &options, &mut Quiet::default()).expect("a mesh");
    let seconds = clock.elapsed().as_secs_f64();
    (
        [
            seconds,
            processor_seconds() - processor,
            memory("VmHWM") - before,
        ],
        mesh,
    )
}

fn main() {
    println!(
        "| volume | objects | labelled voxels | seconds | processor seconds | seconds per million \
         | processor seconds per million | MB beyond the volume | triangles |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- | --- | --- |");
    let mut latest = f64::INFINITY;
    let mut kept = true;
    for dimensions in SIZES {
        let (labels, objects, voxels) = volume(dimensions);
        let ([seconds, processor, megabytes], mesh) = measure(&labels, dimensions);
        drop(labels);
        let [x, y, z] = dimensions;
        let millions = voxels as f64 / 1e6;
        println!(
            "| {x} × {y} × {z} | {objects} | {millions:.1} million | {seconds:.0} | {processor:.0} \
             | {:.1} | {:.1} | {megabytes:.0} | {} |",
            seconds / millions,
            processor / millions,
            mesh.triangles.len()
        );
        mesh.check_invariants().expect("a sound mesh");
        kept &= megabytes <= MEMORY && processor / millions <= RISE * latest;
        latest = processor / millions;
    }
    assert!(
        kept,
        "beyond {MEMORY} MB, or the time for a voxel rises with the size"
    );
}
