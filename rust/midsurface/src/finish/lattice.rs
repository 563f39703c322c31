//! Lattice planes: along which voxels lie in layers, so that sheets nearly parallel to them come in
//! terraces.
//!
//! With the steps of the volume's voxels as a basis and its reciprocal a*, b*, c*, the layers of the
//! planes (h k l) are d = 1 / |h a* + k b* + l c*| apart. A sheet at an angle δ to them has terraces d
//! high and d / tan δ long. Where d is small they are too low to matter.

use crate::grid::{dot, length, unit, Vec3};

/// A family of parallel lattice planes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct LatticePlane {
    pub normal: Vec3,
    /// Cosines of the angle between it and a sheet's normal: nearness grows from 0 at the first to 1
    /// at the second.
    pub near: [f64; 2],
    /// How far terraces along it, which other filters have lowered, may be off the sheet.
    pub most_off: f64,
}

/// Lengths of the terraces at both ends of nearness, in the finest spacing.
const TERRACES: [f64; 2] = [5.0, 10.0];
/// Largest index, and largest sum of their squares: layers of cubic voxels are then at least a third
/// of a voxel apart, and others' terraces leave less than a tenth of a voxel.
const LARGEST_INDEX: i32 = 2;
const MOST_SQUARES: i32 = 9;
/// A terrace is off by half the distance of the layers, and by half of that after the usual filter.
const MOST_OFF: f64 = 0.25;
/// Cosine of the angle with the slices' axis above which a plane lies along the slices rather than
/// across them: at 45° and beyond lines of neighbouring slices are far apart.
const ALONG_SLICES: f64 = 0.7;

impl LatticePlane {
    /// How nearly parallel to it a sheet is, 0 to 1.
    pub fn nearness(&self, normal: Vec3) -> f64 {
        let [from, to] = self.near;
        let share = ((dot(normal, self.normal).abs() - from) / (to - from)).clamp(0.0, 1.0);
        share * share * (3.0 - 2.0 * share)
    }
}

/// The planes that cross the slices of a volume, whose steps from voxel to voxel are the columns of
/// a matrix. None where these are unknown.
pub(crate) fn planes_across_slices(voxel_steps: [Vec3; 3]) -> Vec<LatticePlane> {
    let steps: [Vec3; 3] = std::array::from_fn(|a| voxel_steps.map(|row| row[a]));
    let finest = steps.map(length).into_iter().fold(f64::INFINITY, f64::min);
    if finest <= 0.0 {
        return Vec::new();
    }
    // The axes are at right angles, in units of the finest spacing.
    let reciprocal = steps.map(|step| step.map(|v| v * finest / dot(step, step)));
    let across = unit(steps[2]);
    let plane = |index: [i32; 3]| {
        let sum: Vec3 =
            std::array::from_fn(|k| (0..3).map(|a| f64::from(index[a]) * reciprocal[a][k]).sum());
        let normal = unit(sum);
        let layers = 1.0 / length(sum);
        let near = TERRACES.map(|terrace| 1.0 / (layers / terrace).hypot(1.0));
        let most_off = MOST_OFF * layers * finest;
        (dot(normal, across).abs() <= ALONG_SLICES).then_some(LatticePlane {
            normal,
            near,
            most_off,
        })
    };
    let all = -LARGEST_INDEX..=LARGEST_INDEX;
    let pairs = || all.clone().flat_map(|h| all.clone().map(move |k| [h, k]));
    let indices = pairs().flat_map(|[h, k]| all.clone().map(move |l| [h, k, l]));
    indices.filter(is_family).filter_map(plane).collect()
}

/// Whether indices are small, without a common divisor, and the first that is not 0 is positive: the
/// negative ones name the same planes.
fn is_family(index: &[i32; 3]) -> bool {
    let squares: i32 = index.iter().map(|i| i * i).sum();
    let first = index.iter().find(|i| **i != 0);
    let all_even = index.iter().all(|i| i % 2 == 0);
    squares <= MOST_SQUARES && first.is_some_and(|i| *i > 0) && !all_even
}

#[cfg(test)]
mod tests {
    use super::{planes_across_slices, LatticePlane};

    const CUBIC: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

    fn nearest(planes: &[LatticePlane], normal: [f64; 3]) -> f64 {
        let nearness = planes.iter().map(|plane| plane.nearness(normal));
        nearness.fold(0.0, f64::max)
    }

    #[test]
    fn families_of_cubic_voxels() {
        let planes = planes_across_slices(CUBIC);
        // (100), (110), (111), (210), (211), (221), without those along the slices.
        assert_eq!(planes.len(), 2 + 2 + 4 + 8 + 8 + 12);
        assert_eq!(nearest(&planes, [1.0, 0.0, 0.0]), 1.0);
        assert_eq!(nearest(&planes, [0.0, 0.0, 1.0]), 0.0);
        let lean = |degrees: f64| [degrees.to_radians().cos(), 0.0, degrees.to_radians().sin()];
        assert_eq!(nearest(&planes, lean(5.7)), 1.0);
        assert!((0.3..0.7).contains(&nearest(&planes, lean(8.5))));
        assert_eq!(nearest(&planes, lean(12.0)), 0.0);
        let third = 1.0 / 3.0;
        assert_eq!(nearest(&planes, [2.0 * third, -third, 2.0 * third]), 1.0);
    }

    #[test]
    fn units_and_turns_do_not_matter() {
        let turned = [[0.0, -2e-9, 0.0], [2e-9, 0.0, 0.0], [0.0, 0.0, 2e-9]];
        let (plain, turned) = (planes_across_slices(CUBIC), planes_across_slices(turned));
        assert_eq!(plain.len(), turned.len());
        for [x, y, z] in [[0.6, 0.8, 0.0], [0.99, 0.141, 0.0], [0.68, 0.67, 0.3]] {
            let [before, after] = [nearest(&plain, [x, y, z]), nearest(&turned, [-y, x, z])];
            assert!((before - after).abs() < 1e-9);
        }
    }

    #[test]
    fn unknown_steps_have_no_planes() {
        assert_eq!(planes_across_slices([[0.0; 3]; 3]), []);
    }
}
