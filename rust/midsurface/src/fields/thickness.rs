//! Both faces of the label as seen from a point of the mid-surface: how thick the label is there,
//! and how far off its middle the point lies.

use crate::fields::interpolation::Sampler;
use crate::fields::ray::{both_ways, Inside, Reach};
use crate::grid::{last_voxel, length, unit, Vec3};

/// The thickness that a point beside the label is given, work units: others are divided by it.
const LEAST: f64 = 0.01;

/// What a point sees of the label, work units.
pub(crate) struct View {
    /// The sheet's unit normal.
    pub normal: Vec3,
    /// Distance between both faces along the normal; twice the distance to the one face where the
    /// other lies outside the volume.
    pub thickness: f64,
    /// How far along the normal the middle is, where both faces are seen.
    pub to_middle: Option<f64>,
    /// How far along the normal the one face is that is seen where the other lies outside the
    /// volume; negative behind the point.
    pub one_face: Option<f64>,
    /// Across which axes a border of the volume cuts off what the ridge field should have seen here.
    pub near_border: [bool; 3],
}

impl View {
    /// Looks both ways along the sheet's normal. Near a border of the volume, where one of these
    /// rays or the ridge field's reach ends in the unknown, the middle is looked for parallel to
    /// the border: across a sheet that is flat nearby, every line's middle is on the mid-surface.
    pub fn new(label: &Inside, from: Vec3, normal: Vec3) -> Self {
        let distance = &label.distance;
        let look = |way: Vec3| both_ways(label, from, way);
        let ahead = look(normal);
        let about = match ahead {
            [Reach::Face(a), Reach::Face(b)] => a + b,
            [Reach::Face(a), Reach::Border] | [Reach::Border, Reach::Face(a)] => 2.0 * a,
            [Reach::Border, Reach::Border] => 2.0 * depth(distance, from),
        };
        let across = parallel_to_border(distance, from, normal, about);
        let near_border = [0, 1, 2].map(|a| across[a] != normal[a]);
        let at_border = near_border.contains(&true);
        // Parallel to all borders that are near, or, in a corner, to the one that helps.
        let single = |a: usize| {
            let turned = std::array::from_fn(|k| if k == a { across[k] } else { normal[k] });
            near_border[a].then_some(turned)
        };
        let ways = std::iter::once(across).chain((0..3).filter_map(single));
        let usable = ways.filter(|way| at_border && length(*way) > 0.5);
        let looks: Vec<(f64, [Reach; 2])> =
            usable.map(|way| (length(way), look(unit(way)))).collect();
        let both = |faces: &[Reach; 2]| matches!(faces, [Reach::Face(_), Reach::Face(_)]);
        let best = looks
            .iter()
            .find(|(_, faces)| both(faces))
            .or(looks.first());
        let (cosine, sideways) = best.map_or((1.0, None), |(c, faces)| (*c, Some(*faces)));
        // In a corner one way may see the one face, and another way the other.
        let seen = |side: usize| {
            let first = std::iter::once((cosine, sideways.unwrap_or(ahead)));
            let mut ways = first.chain(looks.iter().copied()).chain([(1.0, ahead)]);
            ways.find_map(|(cosine, faces)| match faces[side] {
                Reach::Face(t) => Some(t * cosine),
                Reach::Border => None,
            })
        };
        let (faces, one_face) = match (seen(0), seen(1)) {
            (Some(a), Some(b)) => (Some([a, b]), None),
            (Some(a), None) => (None, Some(a)),
            (None, Some(b)) => (None, Some(-b)),
            (None, None) => (None, None),
        };
        let thickness = match (ahead, faces, sideways) {
            ([Reach::Face(a), Reach::Face(b)], ..) | (_, Some([a, b]), _) => a + b,
            (.., Some([Reach::Face(a), _] | [_, Reach::Face(a)])) => 2.0 * a * cosine,
            _ => about,
        };
        let thickness = thickness.max(LEAST);
        let to_middle = faces.map(|[a, b]| 0.5 * (a - b));
        Self {
            normal,
            thickness,
            to_middle,
            one_face,
            near_border,
        }
    }

    /// Whether any border of the volume is so near.
    pub fn at_border(&self) -> bool {
        self.near_border.contains(&true)
    }
}

/// The part of the normal that is parallel to all borders that are so near that the ridge field
/// missed a part of the sheet beyond them.
fn parallel_to_border(distance: &Sampler, p: Vec3, normal: Vec3, thickness: f64) -> Vec3 {
    let last = last_voxel(distance.directory.dimensions, distance.h);
    let near = |a: usize| {
        // The field reaches half a thickness to the face, and as far again by its Gaussian.
        p[a].min(last[a] - p[a]) < thickness * normal[a].abs() + 1e-6
    };
    std::array::from_fn(|a| if near(a) { 0.0 } else { normal[a] })
}

/// Distance to the outside at the voxel nearest to a point, 0 outside the label.
pub(crate) fn depth(distance: &Sampler, p: Vec3) -> f64 {
    distance.nearest(std::array::from_fn(|a| p[a] / distance.h[a]))
}
