//! What is asked of a mesh.

use crate::judge::Report;
use crate::phantom::Phantom;

/// What a mesh must be like, and what it should be like.
#[derive(Debug, Clone, PartialEq)]
pub struct Grades {
    /// Below this a mesh is wrong.
    pub must: Limits,
    /// This is worth working for.
    pub aim: Limits,
}

/// Limits on a report; infinite where nothing is asked. Lengths in voxels.
#[derive(Debug, Clone, PartialEq)]
pub struct Limits {
    /// Root mean square distance to the truth.
    pub rms: f64,
    /// The same, away from rims and the border.
    pub rms_inside: f64,
    /// Mean signed distance.
    pub bias: f64,
    /// Largest distance to the truth, rims included.
    pub max_error: f64,
    /// All of the truth is this near to the mesh: 1 or 0.6.
    pub farthest: f64,
    /// Mean error of the normals, degrees.
    pub normal_error: f64,
    /// Topology is exact; at junctions, each piece is a disk.
    pub topology: bool,
    /// Widest gap between a junction's line and a sheet.
    pub junction_gap: f64,
    /// Mean Q, at least.
    pub quality_mean: f64,
    /// Mean smallest angle, degrees, at least.
    pub smallest_angle_mean: f64,
    /// Smallest angle anywhere, degrees, at least.
    pub smallest_angle: f64,
    /// Share of the points inside with 5 to 7 edges, at least.
    pub valence_567: f64,
    /// Share of the points inside with 6 edges, at least.
    pub valence_6: f64,
}

const MUST: Limits = Limits {
    rms: 0.08,
    rms_inside: f64::INFINITY,
    bias: f64::INFINITY,
    max_error: 0.6,
    farthest: 1.0,
    normal_error: 3.0,
    topology: true,
    junction_gap: 0.5,
    quality_mean: 0.93,
    smallest_angle_mean: 53.5,
    smallest_angle: 25.0,
    valence_567: 1.0,
    valence_6: 0.0,
};

const AIM: Limits = Limits {
    rms: 0.03,
    max_error: 0.3,
    farthest: 0.6,
    normal_error: 1.0,
    quality_mean: 0.95,
    smallest_angle_mean: 55.0,
    smallest_angle: 30.0,
    valence_6: 0.85,
    ..MUST
};

impl Grades {
    pub(super) const fn usual() -> Self {
        Self {
            must: MUST,
            aim: AIM,
        }
    }

    pub(super) const fn usual_with_noise() -> Self {
        let (mut must, mut aim) = (MUST, AIM);
        (must.rms, aim.rms) = (0.10, 0.05);
        Self { must, aim }
    }
}

impl Limits {
    /// Every column the report falls short in, with the figures.
    pub fn missed(&self, report: &Report, phantom: &Phantom) -> Vec<(&'static str, String)> {
        let mut missed = self.missed_lengths(report, phantom);
        let mut miss = |column: &'static str, text: String| missed.push((column, text));
        for (count, fault) in report.faults() {
            if count > 0 {
                miss(fault, format!("{count} {fault}"));
            }
        }
        if report.angles_over_120 > 0 {
            miss(
                "obtuse",
                format!("{} angles > 120°", report.angles_over_120),
            );
        }
        let found = report.connectivity.topology;
        let sheets_are_disks = found.euler == found.components as i64
            && found.boundary_loops == found.components
            && found.components > 0;
        let right = match phantom.topology {
            Some(expected) => found == expected,
            None => phantom.junction.is_none() || sheets_are_disks,
        };
        if self.topology && !right {
            let wanted = phantom
                .topology
                .map_or("disks".to_owned(), |t| t.to_string());
            miss("topology", format!("topology {found} not {wanted}"));
        }
        let shape = [
            ("Q", report.quality_mean, self.quality_mean),
            (
                "angle mean",
                report.smallest_angle_mean,
                self.smallest_angle_mean,
            ),
            ("angle min", report.smallest_angle, self.smallest_angle),
            ("V567", report.connectivity.valence_567, self.valence_567),
            ("V6", report.connectivity.valence_6, self.valence_6),
        ];
        for (column, value, least) in shape {
            if value.is_nan() || value < least {
                miss(column, format!("{column} {value:.3} < {least}"));
            }
        }
        missed
    }

    /// Limits on lengths, where a figure that is no number falls short, too.
    fn missed_lengths(&self, report: &Report, phantom: &Phantom) -> Vec<(&'static str, String)> {
        let spacing = phantom.frame.spacing;
        let coarsest = spacing.into_iter().fold(0.0, f64::max) / phantom.frame.unit();
        let lengths = [
            ("rms", report.rms, self.rms),
            ("rms inside", report.rms_inside, self.rms_inside),
            ("bias", report.mean_signed.abs(), self.bias),
            ("max", report.max_error, self.max_error),
            ("far", report.farthest, self.farthest),
            ("normals", report.normal_error, self.normal_error),
            ("gap", report.junction_gap.unwrap_or(0.0), self.junction_gap),
        ];
        let missed = lengths
            .into_iter()
            .map(|(column, value, most)| (column, value, most * coarsest))
            .filter(|(_, value, most)| most.is_finite() && (value.is_nan() || value > most));
        missed
            .map(|(column, value, most)| (column, format!("{column} {value:.3} > {most:.3}")))
            .collect()
    }
}
