//! Ready-made phantoms. Thickness and positions in world units; topology within the volume.

use crate::phantom::{Frame, Phantom, Slab, Thickness, Topology};
use crate::shape::{Hole, Rim, Shape};
use crate::vector::{add, perpendicular, scale, unit, Vec3};

fn slab(shape: Shape, thickness: f64) -> Slab {
    Slab {
        shape,
        thickness: Thickness::Constant(thickness),
        label: 1,
    }
}

fn topology(components: usize, euler: i64, boundary_loops: usize) -> Option<Topology> {
    Some(Topology {
        components,
        euler,
        boundary_loops,
    })
}

/// A closed sphere in the middle of the volume.
pub fn sphere(frame: Frame, radius: f64, thickness: f64) -> Phantom {
    let centre = frame.middle();
    let shape = Shape::Sphere { centre, radius };
    Phantom::new(
        "sphere",
        frame,
        vec![slab(shape, thickness)],
        topology(1, 2, 0),
    )
}

/// Closed spheres round the middle of the volume, one inside the other, one label.
pub fn nested_spheres(frame: Frame, radii: &[f64], thickness: f64) -> Phantom {
    let centre = frame.middle();
    let slabs: Vec<Slab> = radii
        .iter()
        .map(|&radius| slab(Shape::Sphere { centre, radius }, thickness))
        .collect();
    let expected = topology(slabs.len(), 2 * slabs.len() as i64, 0);
    Phantom::new("nested spheres", frame, slabs, expected)
}

/// A sphere cut open: what lies within `opening` degrees of `axis`.
pub fn cap(frame: Frame, radius: f64, axis: Vec3, opening: f64, thickness: f64) -> Phantom {
    let shape = Shape::Cap {
        centre: frame.middle(),
        radius,
        axis,
        opening,
    };
    Phantom::new(
        "cap",
        frame,
        vec![slab(shape, thickness)],
        topology(1, 1, 1),
    )
}

/// A torus round `axis`.
pub fn torus(
    frame: Frame,
    axis: Vec3,
    ring_radius: f64,
    tube_radius: f64,
    thickness: f64,
) -> Phantom {
    let shape = Shape::Torus {
        centre: frame.middle(),
        axis,
        ring_radius,
        tube_radius,
    };
    Phantom::new(
        "torus",
        frame,
        vec![slab(shape, thickness)],
        topology(1, 0, 0),
    )
}

/// A tube through both z faces of the volume.
pub fn tube(frame: Frame, radius: f64, thickness: f64) -> Phantom {
    let shape = Shape::Tube {
        centre: frame.middle(),
        axis: [0.0, 0.0, 1.0],
        radius,
    };
    Phantom::new(
        "tube",
        frame,
        vec![slab(shape, thickness)],
        topology(1, 0, 2),
    )
}

/// A plane through the middle of the volume that leaves it on all sides, with round holes.
pub fn sheet(frame: Frame, normal: Vec3, thickness: f64, holes: &[Hole]) -> Phantom {
    let shape = Shape::Plane {
        centre: frame.middle(),
        normal,
        rim: Rim::None,
        holes: holes.to_vec(),
    };
    let expected = topology(1, 1 - holes.len() as i64, 1 + holes.len());
    Phantom::new("sheet", frame, vec![slab(shape, thickness)], expected)
}

/// A hole in the middle of the volume.
pub fn hole_in_the_middle(frame: &Frame, radius: f64) -> Hole {
    Hole {
        centre: frame.middle(),
        radius,
    }
}

/// A round disk in the middle of the volume, with a round hole in its middle where
/// `hole_radius` > 0.
pub fn disk(
    frame: Frame,
    normal: Vec3,
    radius: f64,
    hole_radius: f64,
    thickness: Thickness,
) -> Phantom {
    let holes = (hole_radius > 0.0).then(|| hole_in_the_middle(&frame, hole_radius));
    let expected = if holes.is_some() {
        topology(1, 0, 2)
    } else {
        topology(1, 1, 1)
    };
    let shape = Shape::Plane {
        centre: frame.middle(),
        normal,
        rim: Rim::Circle(radius),
        holes: holes.into_iter().collect(),
    };
    let slab = Slab {
        shape,
        thickness,
        label: 1,
    };
    Phantom::new("disk", frame, vec![slab], expected)
}

/// A disk whose thickness grows linearly from one end to the other.
pub fn wedge_disk(frame: Frame, normal: Vec3, radius: f64, from: f64, to: f64) -> Phantom {
    let across = perpendicular(unit(normal));
    let thickness = Thickness::Linear {
        from,
        to,
        start: add(frame.middle(), scale(-radius, across)),
        along: scale(2.0 * radius, across),
    };
    Phantom {
        name: "wedge disk".to_owned(),
        ..disk(frame, normal, radius, 0.0, thickness)
    }
}

/// A gyroid that leaves the volume on all sides.
pub fn gyroid(frame: Frame, period: f64, thickness: f64) -> Phantom {
    let centre = frame.middle();
    let shape = Shape::Gyroid { centre, period };
    Phantom::new("gyroid", frame, vec![slab(shape, thickness)], None)
}

/// Two parallel planes, `gap` of background between their faces, with the labels given. A gap of
/// 0 with two different labels makes them touch.
pub fn two_sheets(
    frame: Frame,
    normal: Vec3,
    thickness: f64,
    gap: f64,
    labels: [u8; 2],
) -> Phantom {
    let apart = 0.5 * (thickness + gap);
    let slabs = [-apart, apart]
        .into_iter()
        .zip(labels)
        .map(|(offset, label)| {
            let shape = Shape::Plane {
                centre: add(frame.middle(), scale(offset, unit(normal))),
                normal,
                rim: Rim::None,
                holes: Vec::new(),
            };
            Slab {
                label,
                ..slab(shape, thickness)
            }
        });
    let slabs = slabs.collect();
    Phantom::new("two sheets", frame, slabs, topology(2, 2, 2))
}

/// A plane, and a second one at right angles that ends on it.
pub fn junction(frame: Frame, normal: Vec3, thickness: f64) -> Phantom {
    let centre = frame.middle();
    let branch_normal = perpendicular(unit(normal));
    let plane = |normal, rim| Shape::Plane {
        centre,
        normal,
        rim,
        holes: Vec::new(),
    };
    let slabs = vec![
        slab(plane(normal, Rim::None), thickness),
        slab(plane(branch_normal, Rim::Line(unit(normal))), thickness),
    ];
    Phantom::new("junction", frame, slabs, None)
}
