//! The phantoms against themselves: closest points against brute force, labels against volumes.

use phantoms::*;

fn all() -> Vec<Phantom> {
    let cube = || Frame::new([48; 3]);
    let tilted = leaning(35.0, 20.0);
    let mut shifted = Frame::with_spacing([40, 48, 30], [1.2, 1.0, 1.6]);
    shifted.origin = [100.0, -7.0, 3.0];
    shifted.extent_start = [5, -3, 2];
    let hole = hole_in_the_middle(&shifted, 8.0);
    vec![
        sphere(cube(), 15.0, 4.0),
        nested_spheres(cube(), &[8.0, 18.0], 4.0),
        cap(cube(), 15.0, [1.0, 0.3, 0.2], 100.0, 4.0),
        torus(cube(), [0.2, 0.0, 1.0], 13.0, 6.0, 3.0),
        tube(cube(), 15.0, 4.0),
        sheet(shifted, tilted, 4.0, &[hole]),
        disk(cube(), tilted, 17.0, 6.0, Thickness::Constant(4.0)),
        wedge_disk(cube(), tilted, 17.0, 3.0, 12.0),
        two_sheets(cube(), tilted, 4.0, 2.0, [1, 2]),
        junction(cube(), tilted, 4.0),
        gyroid(cube(), 36.0, 4.0),
    ]
}

#[test]
fn closest_points_agree_with_brute_force() {
    for phantom in all() {
        let step = 0.5;
        let samples = phantom.truth_samples(step);
        assert!(samples.len() > 500, "{}", phantom.name);
        let mut random = fastrand::Rng::with_seed(3);
        let mut tried = 0;
        while tried < 200 {
            let index = phantom
                .frame
                .dimensions
                .map(|n| random.f64() * (n as f64 - 1.0));
            let p = phantom.frame.world(index);
            let (closest, _) = phantom.closest(p);
            // Far from a gyroid the search may end at another sheet, where no phantom looks.
            if closest.distance > 6.0 || !phantom.frame.holds(closest.point) {
                continue;
            }
            tried += 1;
            let nearest = samples
                .iter()
                .map(|s| (0..3).map(|a| (s[a] - p[a]).powi(2)).sum::<f64>().sqrt())
                .fold(f64::INFINITY, f64::min);
            let name = &phantom.name;
            assert!(
                nearest > closest.distance - 1e-3,
                "{name}: {nearest} {closest:?}"
            );
            assert!(
                nearest < closest.distance + 2.0 * step,
                "{name}: {nearest} {closest:?}"
            );
        }
    }
}

#[test]
fn samples_lie_on_the_truth() {
    for phantom in all() {
        for p in phantom.truth_samples(1.0) {
            let distance = phantom.closest(p).0.distance;
            assert!(distance < 1e-3, "{}: {distance}", phantom.name);
        }
    }
}

#[test]
fn labels_fill_the_slab() {
    let (radius, thickness) = (15.0, 4.0);
    let phantom = sphere(Frame::new([48; 3]), radius, thickness);
    let filled = phantom.labels.iter().filter(|&&l| l == 1).count() as f64;
    let face = |r: f64| 4.0 / 3.0 * std::f64::consts::PI * r.powi(3);
    let expected = face(radius + thickness / 2.0) - face(radius - thickness / 2.0);
    assert!(
        (filled / expected - 1.0).abs() < 0.01,
        "{filled} {expected}"
    );
}

#[test]
fn thickness_and_rims_are_in_world_units() {
    for scale in [1.0, 1e-3, 250.0] {
        let frame = Frame::with_spacing([48; 3], [scale; 3]);
        let thick = Thickness::Constant(4.3 * scale);
        let phantom = disk(frame, leaning(35.0, 20.0), 17.2 * scale, 6.1 * scale, thick);
        let reference = disk(
            Frame::new([48; 3]),
            leaning(35.0, 20.0),
            17.2,
            6.1,
            Thickness::Constant(4.3),
        );
        assert_eq!(phantom.labels, reference.labels);
    }
}

#[test]
fn rims_are_flat() {
    let phantom = disk(
        Frame::new([64; 3]),
        [0.0, 0.0, 1.0],
        20.0,
        0.0,
        Thickness::Constant(8.0),
    );
    let in_slice = |z: usize| -> usize {
        let slice = &phantom.labels[z * 4096..(z + 1) * 4096];
        slice.iter().filter(|&&l| l != 0).count()
    };
    assert!(in_slice(31) > 1200);
    assert_eq!(in_slice(28), in_slice(31));
    assert_eq!(in_slice(27), 0);
}

#[test]
fn noise_is_of_the_given_size_and_repeatable() {
    let clean = sphere(Frame::new([48; 3]), 15.0, 4.0);
    let flips = |noisy: &Phantom| {
        let pairs = clean.labels.iter().zip(&noisy.labels);
        pairs.filter(|(a, b)| a != b).count()
    };
    let boundary = flips(&clean.clone().with_noise(1.0, 1)) as f64;
    let noisy = clean.clone().with_noise(0.05, 1);
    assert!((flips(&noisy) as f64 / boundary - 0.05).abs() < 0.01);
    assert_eq!(noisy, clean.clone().with_noise(0.05, 1));
    assert_ne!(noisy, clean.clone().with_noise(0.05, 2));
    assert_eq!(clean, clean.clone().with_noise(0.0, 1));
}

#[test]
fn touching_sheets_touch() {
    let phantom = two_sheets(Frame::new([48; 3]), leaning(20.0, 33.0), 4.0, 0.0, [1, 2]);
    let touching = phantom
        .labels
        .windows(2)
        .filter(|pair| matches!(pair, [1, 2] | [2, 1]));
    assert!(touching.count() > 500);
}

#[test]
fn world_and_index_are_inverse() {
    let mut frame = Frame::with_spacing([10, 20, 30], [0.5, 2.0, 3.0]);
    frame.origin = [4.0, -5.0, 6.0];
    frame.extent_start = [2, 0, -7];
    frame.direction = [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
    let index = [1.5, 17.25, 20.0];
    let back = frame.index(frame.world(index));
    assert!(
        (0..3).all(|a| (back[a] - index[a]).abs() < 1e-12),
        "{back:?}"
    );
    assert_eq!(frame.world([0.0; 3]), [4.0, -4.0, -15.0]);
}
