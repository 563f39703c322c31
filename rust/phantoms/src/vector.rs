//! Vectors in three dimensions.

/// A point or vector, x, y, z.
pub type Vec3 = [f64; 3];

/// a + b.
pub fn add(a: Vec3, b: Vec3) -> Vec3 {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// a − b.
pub fn sub(a: Vec3, b: Vec3) -> Vec3 {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// a · b.
pub fn dot(a: Vec3, b: Vec3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// a × b.
pub fn cross(a: Vec3, b: Vec3) -> Vec3 {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// t a.
pub fn scale(t: f64, a: Vec3) -> Vec3 {
    [t * a[0], t * a[1], t * a[2]]
}

/// Length of a.
pub fn length(a: Vec3) -> f64 {
    dot(a, a).sqrt()
}

/// a scaled to length 1; the x axis where a is zero, since any direction will do there.
pub fn unit(a: Vec3) -> Vec3 {
    let l = length(a);
    if l > 1e-300 {
        scale(1.0 / l, a)
    } else {
        [1.0, 0.0, 0.0]
    }
}

/// A unit vector at right angles to the unit vector n.
pub fn perpendicular(n: Vec3) -> Vec3 {
    let least = (0..3)
        .min_by(|&a, &b| n[a].abs().total_cmp(&n[b].abs()))
        .unwrap_or(0);
    let mut axis = [0.0; 3];
    axis[least] = 1.0;
    unit(cross(n, axis))
}

/// The unit normal of a sheet that leans `tilt` degrees away from upright (0: the sheet contains
/// the z axis, 90: it lies flat), its horizontal part `azimuth` degrees from the x axis.
pub fn leaning(tilt: f64, azimuth: f64) -> Vec3 {
    let (t, a) = (tilt.to_radians(), azimuth.to_radians());
    [t.cos() * a.cos(), t.cos() * a.sin(), t.sin()]
}
