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
        pit(cube()),
        ridge(cube()),
        bent_tube(cube()),
    ]
}

fn single(name: &str, frame: Frame, shape: Shape) -> Phantom {
    let slab = Slab {
        shape,
        thickness: Thickness::Constant(3.0),
        label: 1,
    };
    Phantom::new(name, frame, vec![slab], None)
}

/// A disk with a pit in its middle.
fn pit(frame: Frame) -> Phantom {
    let shape = Shape::Revolved {
        centre: frame.middle(),
        axis: leaning(35.0, 20.0),
        profile: Profile::start([0.0, -14.0], 0.0)
            .turn(4.0, 90.0)
            .forward(3.0)
            .turn(5.0, -90.0)
            .forward(9.0)
            .with_rims([false, true]),
    };
    single("pit", frame, shape)
}

/// A sheet that rises and falls, with a rim on one side.
fn ridge(frame: Frame) -> Phantom {
    let shape = Shape::Extruded {
        centre: frame.middle(),
        across: [0.6, 0.8, 0.0],
        up: [0.0, 0.0, 1.0],
        profile: Profile::start([-18.0, -8.0], 0.0)
            .forward(6.0)
            .turn(6.0, 90.0)
            .turn(6.0, -180.0)
            .turn(6.0, 90.0)
            .forward(200.0)
            .with_rims([true, false]),
    };
    single("ridge", frame, shape)
}

fn bent_tube(frame: Frame) -> Phantom {
    let shape = Shape::BentTube {
        centre: frame.middle(),
        across: [0.6, 0.0, 0.8],
        up: [0.0, 1.0, 0.0],
        path: Profile::start([-200.0, 0.0], 0.0)
            .forward(200.0)
            .turn(14.0, 80.0)
            .forward(200.0),
        radius: 7.0,
    };
    single("bent tube", frame, shape)
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

/// The surface falls away from the closest point at right angles, or the point is beyond a rim.
#[test]
fn normals_stand_on_the_surface() {
    let mut random = fastrand::Rng::with_seed(8);
    for phantom in all() {
        let mut tried = 0;
        while tried < 300 {
            let reach = phantom.frame.dimensions.map(|n| n as f64 - 1.0);
            let p = phantom.frame.world(reach.map(|r| r * random.f64()));
            let (closest, _) = phantom.closest(p);
            if !closest.within_rim || closest.distance > 3.0 || closest.distance < 0.01 {
                continue;
            }
            tried += 1;
            for a in 0..3 {
                let back = p[a] - closest.offset * closest.normal[a];
                let off = (back - closest.point[a]).abs();
                // The gyroid's closest point is found by iteration.
                assert!(off < 0.02, "{} {p:?} {closest:?}", phantom.name);
            }
        }
    }
}

/// Lengths to the rim, by looking for the nearest point of the surface that is beyond it.
#[test]
fn rims_are_as_far_as_told() {
    let frame = || Frame::new([48; 3]);
    let normal = leaning(35.0, 20.0);
    let disk = disk(frame(), normal, 17.0, 6.0, Thickness::Constant(4.0));
    let middle = frame().middle();
    for p in disk.truth_samples(1.0) {
        let from_middle = (0..3)
            .map(|a| (p[a] - middle[a]).powi(2))
            .sum::<f64>()
            .sqrt();
        let expected = (17.0 - from_middle).min(from_middle - 6.0);
        assert!((disk.closest(p).0.from_rim - expected).abs() < 1e-6);
    }
    let cap = cap(frame(), 15.0, [0.0, 0.0, 1.0], 100.0, 4.0);
    let pole = [middle[0], middle[1], middle[2] + 15.0];
    let expected = 15.0 * 100f64.to_radians();
    assert!((cap.closest(pole).0.from_rim - expected).abs() < 1e-9);
    let pit = pit(frame());
    let bottom: Vec3 = std::array::from_fn(|a| middle[a] - 14.0 * normal[a]);
    let expected = 3.0 + 9.0 + (4.0 + 5.0) * std::f64::consts::FRAC_PI_2;
    assert!((pit.closest(bottom).0.from_rim - expected).abs() < 1e-9);
}

/// Number of 6-connected parts of the voxels outside, and of 26-connected ones inside.
fn parts(phantom: &Phantom) -> [usize; 2] {
    let [nx, ny, nz] = phantom.frame.dimensions.map(|n| n as i64);
    let at = |[x, y, z]: [i64; 3]| (x + nx * (y + ny * z)) as usize;
    let mut seen = vec![false; phantom.labels.len()];
    let mut counts = [0; 2];
    for start in 0..seen.len() as i64 {
        let place = [start % nx, start / nx % ny, start / nx / ny];
        if seen[at(place)] {
            continue;
        }
        let inside = phantom.labels[at(place)] != 0;
        counts[usize::from(inside)] += 1;
        seen[at(place)] = true;
        let mut open = vec![place];
        while let Some([x, y, z]) = open.pop() {
            for step in 0..27 {
                let [i, j, k] = [step % 3 - 1, step / 3 % 3 - 1, step / 9 - 1];
                let next = [x + i, y + j, z + k];
                let apart = i.abs() + j.abs() + k.abs();
                let within = (0..3).all(|a| next[a] >= 0 && next[a] < [nx, ny, nz][a]);
                if !within || (!inside && apart > 1) || seen[at(next)] {
                    continue;
                }
                if (phantom.labels[at(next)] != 0) == inside {
                    seen[at(next)] = true;
                    open.push(next);
                }
            }
        }
    }
    counts
}

#[test]
fn one_layer_of_voxels_has_no_hole() {
    for seed in 0..6 {
        let mut dice = Dice::new("one layer", seed);
        for neighbours in [Neighbours::Six, Neighbours::TwentySix] {
            let frame = Frame::new([40; 3]);
            let (centre, normal) = (dice.place(&frame, 3.0), dice.direction());
            let layer = |shape| Slab {
                shape,
                thickness: Thickness::OneVoxel(neighbours),
                label: 1,
            };
            let plane = Shape::Plane {
                centre,
                normal,
                rim: Rim::None,
                holes: Vec::new(),
            };
            let radius = dice.between(10.0, 15.0);
            for shape in [plane, Shape::Sphere { centre, radius }] {
                let phantom = Phantom::new("", frame.clone(), vec![layer(shape)], None);
                let told = format!("seed {seed}: {:?}", phantom.slabs);
                assert_eq!(parts(&phantom), [2, 1], "{told}");
            }
        }
    }
}

#[test]
fn one_layer_is_one_voxel_thick() {
    let frame = Frame::new([40; 3]);
    let mut dice = Dice::new("thickness", 3);
    for _ in 0..10 {
        let normal = dice.direction();
        let axis = (0..3)
            .max_by(|&a, &b| normal[a].abs().total_cmp(&normal[b].abs()))
            .unwrap();
        let slab = Slab {
            shape: Shape::Plane {
                centre: dice.place(&frame, 3.0),
                normal,
                rim: Rim::None,
                holes: Vec::new(),
            },
            thickness: Thickness::OneVoxel(Neighbours::TwentySix),
            label: 1,
        };
        let phantom = Phantom::new("", frame.clone(), vec![slab], None);
        let stride = [1, 40, 1600][axis];
        let doubled = (0..phantom.labels.len() - stride)
            .filter(|&i| i / stride % 40 != 39)
            .filter(|&i| phantom.labels[i] != 0 && phantom.labels[i + stride] != 0);
        assert_eq!(doubled.count(), 0);
    }
}
