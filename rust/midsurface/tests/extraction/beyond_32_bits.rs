//! Volumes with more voxels than 32 bits can number.

use bytemuck::allocation::try_zeroed_vec;
use midsurface::{extract, Grid, Method, Options, Quiet, Volume};

/// Slice 1024 begins with voxel 2³². Voxels that nothing is written to take no memory.
const DIMENSIONS: [usize; 3] = [2048, 2048, 1060];
const CENTRE: [usize; 3] = [2020, 2020, 1036];
const RADIUS: f64 = 16.0;

/// A sphere whose faces are 4 apart, mostly beyond that voxel; `None` where so much is refused.
fn labels() -> Option<Vec<u8>> {
    let mut labels = try_zeroed_vec(DIMENSIONS.iter().product()).ok()?;
    let [xs, ys, zs] = CENTRE.map(|c| c - 20..c + 21);
    for (z, y) in zs.flat_map(|z| ys.clone().map(move |y| (z, y))) {
        for x in xs.clone() {
            let beside = [x, y, z].map(|v| v as f64);
            if (from_centre(beside) - RADIUS).abs() < 2.0 {
                labels[(z * DIMENSIONS[1] + y) * DIMENSIONS[0] + x] = 1;
            }
        }
    }
    Some(labels)
}

fn from_centre(p: [f64; 3]) -> f64 {
    let squares = (0..3).map(|a| (p[a] - CENTRE[a] as f64).powi(2));
    squares.sum::<f64>().sqrt()
}

#[test]
fn a_volume_of_more_voxels_than_32_bits_can_number() {
    let Some(labels) = labels() else {
        println!("skipped: 4.4 GB are refused here, even if hardly any of them are used");
        return;
    };
    let volume = Volume::new(&labels, Grid::new(DIMENSIONS)).unwrap();
    for method in [Method::RidgeSurface, Method::PolylineZipper] {
        let options = Options {
            method,
            ..Options::default()
        };
        let mesh = extract(&volume, &options, &mut Quiet::default()).unwrap();
        assert_eq!(mesh.check_invariants(), Ok(()));
        assert!(mesh.triangles.len() > 1500, "{method:?}");
        for p in &mesh.points {
            let distance = from_centre(p.map(f64::from));
            assert!((distance - RADIUS).abs() < 0.6, "{method:?} {distance}");
        }
    }
}
