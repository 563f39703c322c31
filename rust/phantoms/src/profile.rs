//! Plane curves of straight lines and arcs without kinks, to sweep surfaces from.

use std::f64::consts::{PI, TAU};

/// A point or vector of the plane, x to the right, y up.
pub type Vec2 = [f64; 2];

/// A curve drawn by going straight and turning, so that it has no kink.
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    pieces: Vec<Piece>,
    end: Vec2,
    heading: f64,
    length: f64,
    /// Whether the curve ends in a rim at its start and at its end.
    rims: [bool; 2],
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Piece {
    Line {
        from: Vec2,
        heading: f64,
        length: f64,
    },
    /// `turn` is the angle turned through, positive to the left; `first` where it starts as seen
    /// from the centre.
    Arc {
        centre: Vec2,
        radius: f64,
        first: f64,
        turn: f64,
    },
}

/// The point of a profile that is closest to a given point.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Foot {
    pub point: Vec2,
    /// Unit vector to the left of the curve's direction.
    pub left: Vec2,
    pub distance: f64,
    /// Positive to the left.
    pub offset: f64,
    pub within_rim: bool,
    /// Length of the curve from here to its nearest rim.
    pub from_rim: f64,
}

impl Profile {
    /// Starts at a point, heading so many degrees to the left of the x axis.
    pub fn start(at: Vec2, heading: f64) -> Self {
        Self {
            pieces: Vec::new(),
            end: at,
            heading: heading.to_radians(),
            length: 0.0,
            rims: [false; 2],
        }
    }

    /// Goes straight on.
    #[must_use]
    pub fn forward(mut self, length: f64) -> Self {
        let (sin, cos) = self.heading.sin_cos();
        self.pieces.push(Piece::Line {
            from: self.end,
            heading: self.heading,
            length,
        });
        self.end = [self.end[0] + length * cos, self.end[1] + length * sin];
        self.length += length;
        self
    }

    /// Turns left by so many degrees along an arc; right, where they are negative.
    #[must_use]
    pub fn turn(mut self, radius: f64, degrees: f64) -> Self {
        let turn = degrees.to_radians();
        let to_centre = self.heading + PI / 2.0 * turn.signum();
        let (sin, cos) = to_centre.sin_cos();
        let centre = [self.end[0] + radius * cos, self.end[1] + radius * sin];
        let first = to_centre + PI;
        let (sin, cos) = (first + turn).sin_cos();
        self.pieces.push(Piece::Arc {
            centre,
            radius,
            first,
            turn,
        });
        self.end = [centre[0] + radius * cos, centre[1] + radius * sin];
        self.heading += turn;
        self.length += radius * turn.abs();
        self
    }

    /// Ends in a rim at the start, at the end or both; elsewhere the curve is meant to run on.
    #[must_use]
    pub fn with_rims(mut self, rims: [bool; 2]) -> Self {
        self.rims = rims;
        self
    }

    pub(crate) fn closest(&self, p: Vec2) -> Foot {
        let mut best: Option<Foot> = None;
        let mut before = 0.0;
        for piece in &self.pieces {
            let (along, point, left, length) = piece.closest(p);
            let d = [p[0] - point[0], p[1] - point[1]];
            let distance = d[0].hypot(d[1]);
            if best.is_none_or(|b| distance < b.distance) {
                let side = d[0] * left[0] + d[1] * left[1];
                let s = before + along;
                let sides = [s, self.length - s];
                let to_rim = |end: usize| {
                    if self.rims[end] {
                        sides[end]
                    } else {
                        f64::INFINITY
                    }
                };
                let from_rim = to_rim(0).min(to_rim(1));
                let beyond = from_rim < 1e-9 && distance > side.abs() + 1e-9;
                best = Some(Foot {
                    point,
                    left,
                    distance,
                    offset: if beyond {
                        side
                    } else {
                        distance.copysign(side)
                    },
                    within_rim: !beyond,
                    from_rim,
                });
            }
            before += length;
        }
        best.expect("a profile has a piece")
    }
}

impl Piece {
    /// Length from the piece's start, point, direction to the left, and the piece's length.
    fn closest(&self, p: Vec2) -> (f64, Vec2, Vec2, f64) {
        match *self {
            Piece::Line {
                from,
                heading,
                length,
            } => {
                let (sin, cos) = heading.sin_cos();
                let along = (p[0] - from[0]) * cos + (p[1] - from[1]) * sin;
                let along = along.clamp(0.0, length);
                let point = [from[0] + along * cos, from[1] + along * sin];
                (along, point, [-sin, cos], length)
            }
            Piece::Arc {
                centre,
                radius,
                first,
                turn,
            } => {
                let angle = (p[1] - centre[1]).atan2(p[0] - centre[0]);
                // Angle turned through from the start, in the direction of the turn, 0 to a turn.
                let mut turned = ((angle - first) * turn.signum()).rem_euclid(TAU);
                if turned > turn.abs() {
                    let past_end = turned - turn.abs();
                    turned = if past_end < TAU - turned {
                        turn.abs()
                    } else {
                        0.0
                    };
                }
                let (sin, cos) = (first + turned * turn.signum()).sin_cos();
                let point = [centre[0] + radius * cos, centre[1] + radius * sin];
                let left = [-cos * turn.signum(), -sin * turn.signum()];
                (radius * turned, point, left, radius * turn.abs())
            }
        }
    }
}
