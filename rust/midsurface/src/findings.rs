//! What a run has to tell its user in the end, as counts that add up over batches and processes.

use std::collections::{BTreeMap, BTreeSet};

use crate::execution::Execution;
use crate::grid;
use crate::mesh::Mesh;
use crate::reading::components::Part;

/// The most labels that a message names.
pub(crate) const MOST_LISTED: usize = 20;

/// What was met on the way to a mesh.
#[derive(Debug, Default, Clone, PartialEq)]
pub(crate) struct Findings {
    /// Regions of single slices that are disks.
    pub disks: usize,
    /// Polylines traced, and triangles made of anything.
    pub lines: usize,
    pub triangles: usize,
    /// Whether the volume is a single slice.
    pub is_slice: bool,
    /// Whether the points lie so far from the origin that they are rounded visibly.
    pub is_far: bool,
    /// Components without a surface, counted for each label.
    pub without: BTreeMap<i64, usize>,
}

impl Findings {
    /// Counts the components among some parts that have no triangle in their surface.
    pub fn add_without(&mut self, parts: &[Part], surface: &Mesh) {
        // One by one: a set made at once would ask for memory for all triangles.
        let mut found = BTreeSet::new();
        for of_component in surface.components.chunk_by(|a, b| a == b) {
            found.insert(of_component[0]);
        }
        for component in parts.chunk_by(|a, b| a.component == b.component) {
            if !found.contains(&component[0].component) {
                *self.without.entry(component[0].label).or_default() += 1;
            }
        }
    }

    pub fn add(&mut self, other: &Self) {
        self.disks += other.disks;
        self.lines += other.lines;
        self.triangles += other.triangles;
        self.is_slice |= other.is_slice;
        self.is_far |= other.is_far;
        for (&label, count) in &other.without {
            *self.without.entry(label).or_default() += count;
        }
    }

    /// Tells the user all of it.
    pub fn warn(&self, execution: &mut Execution) {
        if self.is_slice {
            execution.warning(
                "there is no surface: the volume is a single slice, in which a membrane is a line",
            );
        }
        if self.disks > 0 {
            execution.warning(&format!(
                "{} regions of single slices are disks, where the membrane lies flat in the \
                 slices along z, as at the caps of a vesicle: the surface has a gap there",
                self.disks
            ));
        }
        if self.lines > 0 && self.triangles == 0 {
            execution.warning(
                "there is no surface: it takes lines in two neighbouring slices, and this input \
                 has them in single slices only",
            );
        }
        self.warn_of_components_without(execution);
        if self.is_far {
            execution.warning(
                "the volume lies so far from the origin that the points' 32-bit coordinates are \
                 rounded visibly: move its origin nearer to 0",
            );
        }
    }

    fn warn_of_components_without(&self, execution: &mut Execution) {
        for (label, count) in self.without.iter().take(MOST_LISTED) {
            execution.warning(&format!(
                "Label {label}: {count} of its separate pieces gave no surface, since they hold no \
                 sheet that could be followed"
            ));
        }
        if self.without.len() > MOST_LISTED {
            let more = self.without.len() - MOST_LISTED;
            execution.warning(&format!("{more} more labels have pieces without a surface"));
        }
    }

    /// As numbers that another process can be sent.
    pub fn pack(&self) -> Vec<i64> {
        let counts = [self.disks, self.lines, self.triangles];
        let flags = [self.is_slice, self.is_far];
        let mut words: Vec<i64> = counts.iter().map(|&n| n as i64).collect();
        words.extend(flags.map(i64::from));
        for (&label, &count) in &self.without {
            words.extend([label, count as i64]);
        }
        words
    }

    /// What [`Self::pack`] made; nothing where the numbers are too few.
    pub fn unpack(words: &[i64]) -> Self {
        let Some((&[disks, lines, triangles, is_slice, is_far], without)) =
            words.split_first_chunk::<5>()
        else {
            return Self::default();
        };
        Self {
            disks: disks as usize,
            lines: lines as usize,
            triangles: triangles as usize,
            is_slice: is_slice != 0,
            is_far: is_far != 0,
            without: without
                .chunks_exact(2)
                .map(|pair| (pair[0], pair[1] as usize))
                .collect(),
        }
    }
}

/// Whether the points' 32-bit coordinates, the largest being `farthest`, are too coarse for edges
/// of this length, world units.
pub(crate) fn is_far(farthest: f64, edge: f64) -> bool {
    farthest * f64::from(f32::EPSILON) > 0.01 * edge
}

/// [`is_far`] for a whole volume, with edges as long as its finest spacing.
pub(crate) fn is_volume_far(grid: &grid::Grid) -> bool {
    is_far(grid::farthest(&grid.corners()), grid.unit())
}
