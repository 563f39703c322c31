//! Thickness and normals at the points of the mesh.

use phantoms::*;

use crate::measure::{extract_all, grid, mesh_of};

/// Whether a point of a plane sees both faces of the label within the volume.
fn sees_both_faces(frame: &Frame, p: Vec3, normal: Vec3, half: f64) -> bool {
    [-half, half]
        .iter()
        .all(|t| frame.holds(std::array::from_fn(|a| p[a] + t * normal[a])))
}

/// Asserts the thickness at the points of a plane, those at the volume's border, too. Each face is
/// known to half a voxel, so that `slack` is a voxel.
fn assert_thickness(phantom: &Phantom, normal: Vec3, thickness: f64, slack: f64) {
    let mesh = mesh_of(phantom);
    let sees_one =
        |p: &&[f32; 3]| !sees_both_faces(&phantom.frame, p.map(f64::from), normal, 0.5 * thickness);
    let errors = mesh.thickness.iter().map(|&t| f64::from(t) - thickness);
    let wrong: Vec<_> = errors
        .clone()
        .zip(&mesh.points)
        .filter(|(error, _)| error.abs() > slack)
        .collect();
    let worst = wrong.iter().max_by(|a, b| a.0.abs().total_cmp(&b.0.abs()));
    let squares: f64 = errors.map(|error| error * error).sum();
    let rms = (squares / mesh.points.len() as f64).sqrt();
    // In a corner of the volume, where no line across the sheet sees both faces, it is a guess.
    let few = mesh.points.len() / 20;
    assert!(
        wrong.len() <= few && rms <= 0.6 * slack,
        "normal {normal:.2?}: {} of {} points are off by more than {slack}, {} of them where \
         both faces are seen, the worst {worst:?}, root mean square {rms}",
        wrong.len(),
        mesh.points.len(),
        wrong.iter().filter(|(_, p)| !sees_one(p)).count(),
    );
    let at_the_border = mesh.points.iter().filter(sees_one).count();
    assert!(
        at_the_border > 20,
        "the volume's border was to be tested, too"
    );
}

#[test]
fn a_sheet_6_thick_is_6_thick_up_to_the_border() {
    for (tilt, azimuth) in [(0.0, 33.0), (20.0, 33.0), (35.0, 10.0), (45.0, 70.0)] {
        let normal = leaning(tilt, azimuth);
        let phantom = sheet(Frame::new([48; 3]), normal, 6.0, &[]);
        assert_thickness(&phantom, normal, 6.0, 1.0);
    }
}

#[test]
fn thickness_is_in_world_units() {
    let normal = leaning(20.0, 33.0);
    let frame = Frame::with_spacing([48; 3], [12.5; 3]);
    assert_thickness(&sheet(frame, normal, 75.0, &[]), normal, 75.0, 12.5);
    let frame = Frame::with_spacing([48, 48, 24], [1.0, 1.0, 2.0]);
    assert_thickness(&sheet(frame, normal, 8.0, &[]), normal, 8.0, 1.5);
}

#[test]
fn a_label_against_the_border_has_a_surface_or_a_warning() {
    // Voxels 0 to 3 along x: the label's only face is at 3.5.
    let labels: Vec<u8> = (0..6000).map(|i| u8::from(i % 20 < 4)).collect();
    let (mesh, warnings) = extract_all(&labels, midsurface::Grid::new([20, 30, 10]));
    assert!(
        !mesh.triangles.is_empty() || !warnings.is_empty(),
        "nothing, and not a word"
    );
    for (p, &t) in mesh.points.iter().zip(&mesh.thickness) {
        assert!((t - 2.0 * (3.5 - p[0])).abs() <= 0.3, "{t} thick at {p:?}");
    }
}

#[test]
fn a_wedge_is_as_thick_as_it_is() {
    let phantom = wedge_disk(Frame::new([64; 3]), leaning(20.0, 33.0), 24.0, 3.0, 12.0);
    let (mesh, _) = extract_all(&phantom.labels, grid(&phantom.frame));
    let middle = phantom.frame.middle();
    let (mut errors, mut count) = (0.0, 0);
    for (p, &t) in mesh.points.iter().zip(&mesh.thickness) {
        let p = p.map(f64::from);
        let from_middle = (0..3)
            .map(|a| (p[a] - middle[a]).powi(2))
            .sum::<f64>()
            .sqrt();
        if from_middle < 16.0 {
            let (closest, slab) = phantom.closest(p);
            errors += (f64::from(t)
                - slab
                    .thickness
                    .at(closest.point, closest.normal, &phantom.frame))
            .abs();
            count += 1;
        }
    }
    assert!(count > 300);
    let mean = errors / f64::from(count);
    assert!(mean <= 0.5, "mean error {mean}");
}

#[test]
fn normals_of_sheets_are_true_to_3_degrees() {
    for (tilt, azimuth) in [(0.0, 0.0), (0.0, 33.0), (25.0, 33.0), (45.0, 70.0)] {
        let normal = leaning(tilt, azimuth);
        let mesh = mesh_of(&sheet(Frame::new([48; 3]), normal, 4.0, &[]));
        let cosine = |n: &[f32; 3]| (0..3).map(|a| f64::from(n[a]) * normal[a]).sum::<f64>();
        let side = cosine(&mesh.normals[0]).signum();
        let degrees = mesh
            .normals
            .iter()
            .map(|n| (side * cosine(n)).clamp(-1.0, 1.0).acos().to_degrees());
        let mean = degrees.sum::<f64>() / mesh.normals.len() as f64;
        assert!(
            mean <= 3.0,
            "tilt {tilt}, azimuth {azimuth}: {mean} degrees off"
        );
    }
}

#[test]
fn normals_of_a_tube_point_outward() {
    let phantom = tube(Frame::new([64, 64, 16]), 25.0, 6.0);
    let (mesh, middle) = (mesh_of(&phantom), phantom.frame.middle());
    let degrees = mesh.points.iter().zip(&mesh.normals).map(|(p, n)| {
        let (x, y) = (f64::from(p[0]) - middle[0], f64::from(p[1]) - middle[1]);
        let cosine = (x * f64::from(n[0]) + y * f64::from(n[1])) / x.hypot(y);
        cosine.clamp(-1.0, 1.0).acos().to_degrees()
    });
    let mean = degrees.sum::<f64>() / mesh.normals.len() as f64;
    assert!(mean <= 3.0, "{mean} degrees off");
}
