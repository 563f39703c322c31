//! Surfaces whose closest point is known in closed form (the gyroid: to machine precision).

use std::f64::consts::TAU;

use crate::vector::{add, dot, length, perpendicular, scale, sub, unit, Vec3};

/// A mid-surface, world units. Tubes, planes without a rim and gyroids have no end.
#[derive(Debug, Clone, PartialEq)]
#[allow(missing_docs)]
pub enum Shape {
    /// A closed sphere.
    Sphere { centre: Vec3, radius: f64 },
    /// The part of a sphere at most `opening` degrees away from `axis`, as seen from the centre.
    Cap {
        centre: Vec3,
        radius: f64,
        axis: Vec3,
        opening: f64,
    },
    /// A ring of the given radius round `axis`, thickened to a tube.
    Torus {
        centre: Vec3,
        axis: Vec3,
        ring_radius: f64,
        tube_radius: f64,
    },
    /// An endless cylinder.
    Tube {
        centre: Vec3,
        axis: Vec3,
        radius: f64,
    },
    /// A plane with round holes that do not touch each other nor the rim.
    Plane {
        centre: Vec3,
        normal: Vec3,
        rim: Rim,
        holes: Vec<Hole>,
    },
    /// sin x cos y + sin y cos z + sin z cos x = 0, one turn a `period`.
    Gyroid { centre: Vec3, period: f64 },
}

/// Where a plane ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Rim {
    /// Nowhere.
    None,
    /// At a circle of this radius round the plane's centre.
    Circle(f64),
    /// At the line through the plane's centre; the plane lies on the side of this vector.
    Line(Vec3),
}

/// A round hole in a plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hole {
    /// Its centre; only the part within the plane counts.
    pub centre: Vec3,
    /// Its radius.
    pub radius: f64,
}

/// The point of a surface that is closest to a given point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Closest {
    /// The point of the surface, its rim included.
    pub point: Vec3,
    /// Its distance from the given point.
    pub distance: f64,
    /// Signed distance from the surface continued beyond its rim; positive on the side of the
    /// normal (outside of spheres, tori and tubes).
    pub offset: f64,
    /// Whether the given point lies above or below the surface, not beyond its rim.
    pub within_rim: bool,
}

impl Shape {
    /// The point of the surface that is closest to p.
    pub fn closest(&self, p: Vec3) -> Closest {
        match *self {
            Shape::Sphere { centre, radius } => {
                let d = sub(p, centre);
                on_normal(p, length(d) - radius, unit(d))
            }
            Shape::Cap {
                centre,
                radius,
                axis,
                opening,
            } => closest_on_cap(p, centre, radius, unit(axis), opening.to_radians()),
            Shape::Torus {
                centre,
                axis,
                ring_radius,
                tube_radius,
            } => {
                let d = sub(p, centre);
                let ring = add(centre, scale(ring_radius, radial(d, unit(axis)).1));
                let e = sub(p, ring);
                on_normal(p, length(e) - tube_radius, unit(e))
            }
            Shape::Tube {
                centre,
                axis,
                radius,
            } => {
                let (from_axis, outward) = radial(sub(p, centre), unit(axis));
                on_normal(p, from_axis - radius, outward)
            }
            Shape::Plane {
                centre,
                normal,
                rim,
                ref holes,
            } => closest_on_plane(p, centre, unit(normal), rim, holes),
            Shape::Gyroid { centre, period } => closest_on_gyroid(p, centre, TAU / period),
        }
    }
}

fn on_normal(p: Vec3, offset: f64, normal: Vec3) -> Closest {
    Closest {
        point: sub(p, scale(offset, normal)),
        distance: offset.abs(),
        offset,
        within_rim: true,
    }
}

/// Length and direction of the part of d at right angles to the unit vector `axis`.
fn radial(d: Vec3, axis: Vec3) -> (f64, Vec3) {
    let r = sub(d, scale(dot(d, axis), axis));
    let l = length(r);
    (
        l,
        if l > 1e-12 {
            scale(1.0 / l, r)
        } else {
            perpendicular(axis)
        },
    )
}

fn closest_on_cap(p: Vec3, centre: Vec3, radius: f64, axis: Vec3, opening: f64) -> Closest {
    let d = sub(p, centre);
    let (from_axis, outward) = radial(d, axis);
    let whole = on_normal(p, length(d) - radius, unit(d));
    if from_axis.atan2(dot(d, axis)) <= opening {
        return whole;
    }
    let (sin, cos) = opening.sin_cos();
    let rim = add(scale(radius * cos, axis), scale(radius * sin, outward));
    Closest {
        point: add(centre, rim),
        distance: length(sub(d, rim)),
        within_rim: false,
        ..whole
    }
}

fn closest_on_plane(p: Vec3, centre: Vec3, normal: Vec3, rim: Rim, holes: &[Hole]) -> Closest {
    let d = sub(p, centre);
    let offset = dot(d, normal);
    let flat = sub(d, scale(offset, normal));
    // How far beyond each outline, and the way back to it.
    let mut outlines = Vec::with_capacity(holes.len() + 1);
    match rim {
        Rim::None => {}
        Rim::Circle(radius) => outlines.push((length(flat) - radius, scale(-1.0, unit(flat)))),
        Rim::Line(side) => {
            let inward = radial(side, normal).1;
            outlines.push((-dot(flat, inward), inward));
        }
    }
    for hole in holes {
        let (from_hole, outward) = radial(sub(p, hole.centre), normal);
        outlines.push((hole.radius - from_hole, outward));
    }
    let (beyond, back) = outlines
        .into_iter()
        .filter(|(beyond, _)| *beyond > 0.0)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .unwrap_or((0.0, [0.0; 3]));
    Closest {
        point: add(add(centre, flat), scale(beyond, back)),
        distance: offset.hypot(beyond),
        offset,
        within_rim: beyond == 0.0,
    }
}

/// Value and gradient of the gyroid's function, k its wave number.
fn gyroid(p: Vec3, centre: Vec3, k: f64) -> (f64, Vec3) {
    let [(sx, cx), (sy, cy), (sz, cz)] = sub(p, centre).map(|v| (k * v).sin_cos());
    let gradient = [cx * cy - sz * sx, cy * cz - sx * sy, cz * cx - sy * sz];
    (sx * cy + sy * cz + sz * cx, scale(k, gradient))
}

/// The nearest point found while alternating between falling onto the surface and sliding along
/// it towards p. Exact near the surface; half-way between two sheets it may name the farther one.
fn closest_on_gyroid(p: Vec3, centre: Vec3, k: f64) -> Closest {
    let mut point = fall_onto_gyroid(p, centre, k);
    let mut best = point;
    for _ in 0..12 {
        let normal = unit(gyroid(point, centre, k).1);
        let away = sub(p, point);
        let slide = sub(away, scale(dot(away, normal), normal));
        if length(slide) < 1e-6 / k {
            break;
        }
        let step = (0.4 / k / length(slide)).min(1.0);
        point = fall_onto_gyroid(add(point, scale(step, slide)), centre, k);
        if length(sub(p, point)) < length(sub(p, best)) {
            best = point;
        }
    }
    let distance = length(sub(p, best));
    Closest {
        point: best,
        distance,
        offset: distance.copysign(gyroid(p, centre, k).0),
        within_rim: true,
    }
}

/// Newton's method along the gradient, in steps short enough not to jump to another sheet.
fn fall_onto_gyroid(mut point: Vec3, centre: Vec3, k: f64) -> Vec3 {
    for _ in 0..30 {
        let (value, gradient) = gyroid(point, centre, k);
        if value.abs() < 1e-9 {
            break;
        }
        let longest = 0.3 / k;
        let step = (value / length(gradient)).clamp(-longest, longest);
        point = sub(point, scale(step, unit(gradient)));
    }
    point
}
