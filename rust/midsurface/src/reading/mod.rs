//! Volume → parts: scan, labels as asked for, components, and what the user is told about them.
//!
//! | step | file |
//! | --- | --- |
//! | the input | `volume.rs` |
//! | volume → runs of labelled voxels | `runs.rs` |
//! | runs → parts, each with its label and component | `components.rs` |

pub(crate) mod components;
pub(crate) mod runs;
pub(crate) mod volume;

use std::collections::BTreeSet;

use crate::error::{Error, Result};
use crate::execution::Execution;
use crate::findings::MOST_LISTED;
use crate::Options;
use components::{parts, Part, SPECK};
use volume::Volume;

/// Share of the run that reading the labels takes.
pub(crate) const READING: f64 = 0.05;

/// The parts of the wanted labels; tells the user what is missing or left out. Takes the progress
/// up to `until` · [`READING`].
pub(crate) fn read_parts(
    volume: &Volume,
    options: &Options,
    execution: &mut Execution,
    until: f64,
) -> Result<Vec<Part>> {
    execution.within(0.0, until);
    execution.stage("Reading labels", 0.0, READING, 2)?;
    let voxels = volume.grid.voxel_count()?;
    let wanted = Wanted::new(options);
    let scan = runs::scan(volume, voxels, execution, |label| wanted.holds(label))?;
    wanted.report(&scan.labels, execution)?;
    let (mut parts, specks) = parts(scan.runs, execution)?;
    report_specks(specks, execution);
    let found = parts.len();
    parts.retain(|part| part.voxels() < voxels);
    if parts.len() < found {
        report_full(execution);
    }
    Ok(parts)
}

pub(crate) fn report_specks(specks: usize, execution: &mut Execution) {
    if specks > 0 {
        execution.warning(&format!(
            "{specks} specks of fewer than {SPECK} voxels were left out"
        ));
    }
}

pub(crate) fn report_full(execution: &mut Execution) {
    execution.warning("one label fills the whole volume: it has no faces, and so no mid-surface");
}

/// The labels asked for; `None`: all.
pub(crate) struct Wanted(Option<BTreeSet<i64>>);

impl Wanted {
    pub fn new(options: &Options) -> Self {
        let labels = options.labels.as_ref();
        Self(labels.map(|labels| labels.iter().copied().collect()))
    }

    pub fn holds(&self, label: i64) -> bool {
        self.0.as_ref().is_none_or(|wanted| wanted.contains(&label))
    }

    /// Compares the labels asked for with those that are there.
    pub fn report(&self, present: &BTreeSet<i64>, execution: &mut Execution) -> Result<()> {
        if present.is_empty() {
            execution
                .warning("the volume has no label: all its values are 0, so there is no surface");
            return Ok(());
        }
        let Some(wanted) = &self.0 else {
            return Ok(());
        };
        if wanted.is_empty() {
            execution.warning("no label is chosen, so there is no surface");
            return Ok(());
        }
        let list = |labels: &mut dyn Iterator<Item = &i64>| {
            let names: Vec<String> = labels.take(MOST_LISTED).map(i64::to_string).collect();
            names.join(", ")
        };
        let absent = list(&mut wanted.difference(present));
        if wanted.is_disjoint(present) {
            return Err(Error::LabelsAbsent {
                asked: absent,
                present: list(&mut present.iter()),
            });
        }
        if !absent.is_empty() {
            execution.warning(&format!("these labels are not in the volume: {absent}"));
        }
        Ok(())
    }
}
