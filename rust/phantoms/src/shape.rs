//! Surfaces whose closest point is known in closed form (the gyroid: to machine precision).

use std::f64::consts::TAU;

use crate::gyroid::{closest_on_gyroid, least_distance};
use crate::profile::Profile;
use crate::vector::{add, cross, dot, length, perpendicular, scale, sub, unit, Vec3};

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
    /// A profile turned round `axis`: its x is the distance from the axis, its y the height above
    /// `centre`. Offsets are positive to the left of the profile.
    Revolved {
        centre: Vec3,
        axis: Vec3,
        profile: Profile,
    },
    /// A profile drawn along the third direction: its x runs along `across`, its y along `up`,
    /// both counted from `centre`. Offsets are positive to the left of the profile.
    Extruded {
        centre: Vec3,
        across: Vec3,
        up: Vec3,
        profile: Profile,
    },
    /// A tube round a profile, which lies in the plane as that of [`Shape::Extruded`] does.
    BentTube {
        centre: Vec3,
        across: Vec3,
        up: Vec3,
        path: Profile,
        radius: f64,
    },
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
    /// Unit normal of the surface at `point`, to the side where offsets are positive.
    pub normal: Vec3,
    /// Length along the surface from `point` to its nearest rim; infinite without a rim.
    pub from_rim: f64,
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
            Shape::Revolved {
                centre,
                axis,
                ref profile,
            } => closest_on_revolved(p, centre, unit(axis), profile),
            Shape::Extruded {
                centre,
                across,
                up,
                ref profile,
            } => closest_on_extruded(p, centre, unit(across), unit(up), profile),
            Shape::BentTube {
                centre,
                across,
                up,
                ref path,
                radius,
            } => {
                // The nearest point of the path is that to p's shadow on the path's plane.
                let out = cross(unit(across), unit(up));
                let lift = scale(dot(sub(p, centre), out), out);
                let on_path = closest_on_extruded(p, centre, unit(across), unit(up), path).point;
                let e = add(sub(p, on_path), lift);
                on_normal(p, length(e) - radius, unit(e))
            }
        }
    }

    /// Whether it is seen at a glance that the surface is farther away than this.
    pub(crate) fn is_far(&self, p: Vec3, reach: f64) -> bool {
        matches!(self, Shape::Gyroid { .. }) && self.least_distance(p) > reach
    }

    /// A distance that the surface is at least away from p; cheaper than [`Shape::closest`] where
    /// that is dear, and right where it may fail.
    pub(crate) fn least_distance(&self, p: Vec3) -> f64 {
        match *self {
            Shape::Gyroid { centre, period } => least_distance(p, centre, TAU / period),
            _ => self.closest(p).distance,
        }
    }
}

fn on_normal(p: Vec3, offset: f64, normal: Vec3) -> Closest {
    Closest {
        point: sub(p, scale(offset, normal)),
        distance: offset.abs(),
        offset,
        normal,
        from_rim: f64::INFINITY,
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
    let from_pole = from_axis.atan2(dot(d, axis));
    if from_pole <= opening {
        return Closest {
            from_rim: radius * (opening - from_pole),
            ..whole
        };
    }
    let (sin, cos) = opening.sin_cos();
    let rim = add(scale(radius * cos, axis), scale(radius * sin, outward));
    Closest {
        point: add(centre, rim),
        distance: length(sub(d, rim)),
        normal: unit(rim),
        from_rim: 0.0,
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
    let nearest = outlines.into_iter().max_by(|a, b| a.0.total_cmp(&b.0));
    let (past, back) = nearest.unwrap_or((f64::NEG_INFINITY, [0.0; 3]));
    let beyond = past.max(0.0);
    Closest {
        point: add(add(centre, flat), scale(beyond, back)),
        distance: offset.hypot(beyond),
        offset,
        normal,
        from_rim: (-past).max(0.0),
        within_rim: beyond == 0.0,
    }
}

fn closest_on_revolved(p: Vec3, centre: Vec3, axis: Vec3, profile: &Profile) -> Closest {
    let d = sub(p, centre);
    let (from_axis, outward) = radial(d, axis);
    let foot = profile.closest([from_axis, dot(d, axis)]);
    let place = |v: [f64; 2]| add(scale(v[0], outward), scale(v[1], axis));
    Closest {
        point: add(centre, place(foot.point)),
        distance: foot.distance,
        offset: foot.offset,
        normal: place(foot.left),
        from_rim: foot.from_rim,
        within_rim: foot.within_rim,
    }
}

fn closest_on_extruded(
    p: Vec3,
    centre: Vec3,
    across: Vec3,
    up: Vec3,
    profile: &Profile,
) -> Closest {
    let d = sub(p, centre);
    let flat = [dot(d, across), dot(d, up)];
    let foot = profile.closest(flat);
    let place = |v: [f64; 2]| add(scale(v[0], across), scale(v[1], up));
    Closest {
        point: add(sub(p, place(flat)), place(foot.point)),
        distance: foot.distance,
        offset: foot.offset,
        normal: place(foot.left),
        from_rim: foot.from_rim,
        within_rim: foot.within_rim,
    }
}
