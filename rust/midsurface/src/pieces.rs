//! Pieces → parts: the components of a volume that is spread over processes, each whole on one.
//!
//! Every process scans its piece, and from then on only runs travel: a few per cent of the voxels.
//! It finds the components within its piece; the first process is told their sizes and the runs
//! beside other pieces, joins what touches, numbers the components of the whole volume, and deals
//! them out, the largest first, each to the process that has least to do. So no process ever holds
//! the volume or the whole mesh, as long as no single component is most of it. What follows sees
//! whole components and cannot tell that there were pieces.

use std::cmp::Reverse;
use std::collections::BTreeSet;

use crate::components::{
    connected, for_each_touch, parts, sort_by_label, DisjointSets, Part, SPECK,
};
use crate::error::{check_count, collected, filled, push, reserved, Error, Result};
use crate::exchange::Team;
use crate::execution::Execution;
use crate::grid::Grid;
use crate::reading::{report_full, report_specks, Wanted, READING};
use crate::runs::{self, Run, Scan};
use crate::territory::Territory;
use crate::volume::Volume;
use crate::Options;

/// Numbers that describe a component or a run to another process.
const COMPONENT_LENGTH: usize = 5;
const RUN_LENGTH: usize = 4;
/// Stands for the number of a component that is left out.
const LEFT_OUT: i64 = -1;

/// The parts of the components that this process is to work on, numbered as in the whole volume.
pub(crate) fn gather_parts(
    piece: Option<&Volume>,
    whole: &Grid,
    options: &Options,
    team: &mut Team,
    execution: &mut Execution,
) -> Result<Vec<Part>> {
    execution.stage("Reading labels", 0.0, READING, 3)?;
    whole.check()?;
    let voxels = whole.voxel_count()?;
    let territory = Territory::agree(piece, whole, team)?;
    let wanted = Wanted::new(options);
    let scan = match piece {
        Some(volume) => runs::scan(volume, voxels, execution, |label| wanted.holds(label))
            .map_err(|error| territory.place(error))?,
        None => Scan::default(),
    };
    let held = piece.map_or(Ok(0), |volume| volume.grid.voxel_count())?;
    agree_on_labels(&scan, &wanted, held, team, execution)?;
    let mut runs = territory.clip(scan.runs)?;
    sort_by_label(&mut runs);
    let found = LocalComponents::find(&runs)?;
    execution.pass_done()?;
    let decided = found.agree(&runs, &territory, voxels, team, execution)?;
    let (runs, numbers) = deal_out(&runs, &found, &decided, team)?;
    let (mut parts, _) = parts(runs, execution)?;
    // Both count by label, then by size, then by place.
    for part in &mut parts {
        part.component = numbers[part.component as usize];
    }
    Ok(parts)
}

/// All processes learn whether the labels of all pieces can be those of a segmentation.
fn agree_on_labels(
    scan: &Scan,
    wanted: &Wanted,
    held: usize,
    team: &mut Team,
    execution: &mut Execution,
) -> Result<()> {
    let mut message = vec![scan.run_count as i64, held as i64];
    message.extend(&scan.labels);
    let of_all = team.gather(message)?;
    if !team.is_first() {
        return Ok(());
    }
    let mut whole = Scan::default();
    let mut voxels = 0;
    for message in &of_all {
        if let Some((&[runs, held], labels)) = message.split_first_chunk::<2>() {
            // Where pieces overlap, runs and voxels both count as often.
            whole.run_count += runs as usize;
            voxels += held as usize;
            whole.labels.extend(labels);
        }
    }
    whole.check(voxels)?;
    wanted.report(&whole.labels, execution)
}

/// A component within a piece, or the whole of it.
#[derive(Debug, Clone, Copy)]
struct Component {
    label: i64,
    voxels: i64,
    /// z, y, x of the first voxel.
    first: [i64; 3],
}

/// The components within the own piece.
struct LocalComponents {
    components: Vec<Component>,
    /// Component of each run.
    of_run: Vec<u32>,
}

impl LocalComponents {
    /// `runs` are ordered by label, z, y, x.
    fn find(runs: &[Run]) -> Result<Self> {
        check_count("rows of labelled voxels", runs.len(), 1)?;
        let mut found = Self {
            components: Vec::new(),
            of_run: reserved(runs.len())?,
        };
        for of_label in runs.chunk_by(|a, b| a.label == b.label) {
            let mut sets = connected(of_label)?;
            let first = found.of_run.len();
            for (i, run) in of_label.iter().enumerate() {
                let root = sets.find(i);
                // The smallest index stands for a set, so that its number is known by now.
                if root == i {
                    found.of_run.push(found.components.len() as u32);
                    let component = Component {
                        label: run.label,
                        voxels: 0,
                        first: [run.z, run.y, run.start].map(i64::from),
                    };
                    push(&mut found.components, component)?;
                } else {
                    found.of_run.push(found.of_run[first + root]);
                }
                found.components[found.of_run[first + i] as usize].voxels += run.length() as i64;
            }
        }
        Ok(found)
    }

    /// What the first process makes of each component: its number in the whole volume or
    /// [`LEFT_OUT`], and the process that works on it.
    fn agree(
        &self,
        runs: &[Run],
        territory: &Territory,
        voxels: usize,
        team: &mut Team,
        execution: &mut Execution,
    ) -> Result<Vec<[i64; 2]>> {
        let mut message = reserved(1 + COMPONENT_LENGTH * self.components.len())?;
        message.push(self.components.len() as i64);
        for c in &self.components {
            message.extend([c.label, c.voxels, c.first[0], c.first[1], c.first[2]]);
        }
        let beside = runs.iter().zip(&self.of_run);
        for (run, &component) in beside.filter(|(run, _)| territory.is_at_border(run)) {
            for number in pack(run, i64::from(component)) {
                push(&mut message, number)?;
            }
        }
        let of_all = team.gather(message)?;
        let answers = if team.is_first() {
            decide(&of_all, voxels, team.processes(), execution)?
        } else {
            Vec::new()
        };
        let mut answers = team.swap(answers)?;
        let answer = answers.swap_remove(crate::exchange::FIRST);
        collected(answer.chunks_exact(2).map(|pair| [pair[0], pair[1]]))
    }
}

/// A run as it is sent, with a number that belongs to it.
fn pack(run: &Run, number: i64) -> [i64; RUN_LENGTH] {
    let pair = |high: u32, low: u32| i64::from(high) << 32 | i64::from(low);
    [
        number,
        run.label,
        pair(run.z, run.y),
        pair(run.start, run.end),
    ]
}

fn unpack(numbers: &[i64]) -> (Run, i64) {
    let (high, low) = (|n: i64| (n >> 32) as u32, |n: i64| n as u32);
    let run = Run {
        label: numbers[1],
        z: high(numbers[2]),
        y: low(numbers[2]),
        start: high(numbers[3]),
        end: low(numbers[3]),
    };
    (run, numbers[0])
}

/// Joins the components of all pieces, and answers each process as [`LocalComponents::agree`] says.
fn decide(
    of_all: &[Vec<i64>],
    voxels: usize,
    processes: usize,
    execution: &mut Execution,
) -> Result<Vec<Vec<i64>>> {
    let mut components: Vec<Component> = Vec::new();
    let mut beside: Vec<(Run, u32)> = Vec::new();
    let mut starts = vec![0];
    for message in of_all {
        let (count, rest) = message.split_first().ok_or(Error::Pieces)?;
        let described = COMPONENT_LENGTH * *count as usize;
        let (described, runs) = rest.split_at_checked(described).ok_or(Error::Pieces)?;
        let first = components.len() as i64;
        for c in described.chunks_exact(COMPONENT_LENGTH) {
            let component = Component {
                label: c[0],
                voxels: c[1],
                first: [c[2], c[3], c[4]],
            };
            push(&mut components, component)?;
        }
        for numbers in runs.chunks_exact(RUN_LENGTH) {
            let (run, component) = unpack(numbers);
            push(&mut beside, (run, (first + component) as u32))?;
        }
        starts.push(components.len());
    }
    check_count("components", components.len(), 1)?;
    let mut sets = join_across(&mut beside, components.len())?;
    let decided = number_and_deal(&components, &mut sets, voxels, processes, execution)?;
    let of_process =
        |pair: &[usize]| collected(decided[pair[0]..pair[1]].as_flattened().iter().copied());
    starts.windows(2).map(of_process).collect()
}

/// Joins the components whose runs beside other pieces touch.
fn join_across(beside: &mut [(Run, u32)], components: usize) -> Result<DisjointSets> {
    let mut sets = DisjointSets::new(components)?;
    beside.sort_unstable_by_key(|(run, _)| (run.label, run.z, run.y, run.start));
    let runs = collected(beside.iter().map(|(run, _)| *run))?;
    let mut first = 0;
    for of_label in runs.chunk_by(|a, b| a.label == b.label) {
        let component = |i: usize| beside[first + i].1 as usize;
        for i in 1..of_label.len() {
            if follows(&of_label[i - 1], &of_label[i]) {
                sets.join(component(i - 1), component(i));
            }
        }
        for_each_touch(of_label, |a, b, _| {
            sets.join(component(a), component(b));
            Ok(())
        })?;
        first += of_label.len();
    }
    Ok(sets)
}

/// Whether two runs of a label are one that was cut between pieces.
fn follows(before: &Run, run: &Run) -> bool {
    (before.z, before.y, before.end) == (run.z, run.y, run.start)
}

/// Numbers the joined components by label, then by size, the largest first, then by place, and
/// gives the largest first to the process with the fewest voxels so far.
fn number_and_deal(
    components: &[Component],
    sets: &mut DisjointSets,
    voxels: usize,
    processes: usize,
    execution: &mut Execution,
) -> Result<Vec<[i64; 2]>> {
    let mut whole: Vec<Option<Component>> = filled(None, components.len())?;
    for (i, c) in components.iter().enumerate() {
        let joined = whole[sets.find(i)].get_or_insert(Component { voxels: 0, ..*c });
        joined.voxels += c.voxels;
        joined.first = joined.first.min(c.first);
    }
    let mut order: Vec<(usize, Component)> = Vec::new();
    let mut specks = 0;
    for (i, component) in whole.iter().enumerate() {
        match component {
            Some(c) if c.voxels >= SPECK as i64 => push(&mut order, (i, *c))?,
            Some(_) => specks += 1,
            None => {}
        }
    }
    order.sort_unstable_by_key(|(i, c)| (c.label, Reverse(c.voxels), c.first, *i));
    let mut decided = filled([LEFT_OUT, 0], components.len())?;
    for (number, (root, c)) in order.iter().enumerate() {
        if c.voxels as usize == voxels {
            report_full(execution);
        } else {
            decided[*root][0] = number as i64;
        }
    }
    report_specks(specks, execution);
    order.sort_unstable_by_key(|(i, c)| (Reverse(c.voxels), c.label, c.first, *i));
    let mut load = vec![0; processes];
    for (root, c) in &order {
        let owner = (0..processes).min_by_key(|&p| load[p]).unwrap_or(0);
        load[owner] += c.voxels;
        decided[*root][1] = owner as i64;
    }
    collected((0..components.len()).map(|i| decided[sets.find(i)]))
}

/// Sends every run to the process that works on its component. Returns the runs of the own
/// components, in order, and the numbers of these, ascending.
fn deal_out(
    runs: &[Run],
    found: &LocalComponents,
    decided: &[[i64; 2]],
    team: &mut Team,
) -> Result<(Vec<Run>, Vec<u32>)> {
    let mut messages = vec![Vec::new(); team.processes()];
    for (run, &component) in runs.iter().zip(&found.of_run) {
        let [number, owner] = decided[component as usize];
        if number != LEFT_OUT {
            for word in pack(run, number) {
                push(&mut messages[owner as usize], word)?;
            }
        }
    }
    let received = team.swap(messages)?;
    let count = received.iter().map(Vec::len).sum::<usize>() / RUN_LENGTH;
    let mut own: Vec<Run> = reserved(count)?;
    let mut numbers = BTreeSet::new();
    for message in received {
        for packed in message.chunks_exact(RUN_LENGTH) {
            let (run, number) = unpack(packed);
            own.push(run);
            numbers.insert(number as u32);
        }
    }
    own.sort_unstable_by_key(|run| (run.z, run.y, run.start, run.label));
    own.dedup_by(|run, before| {
        let is_same = run.label == before.label && follows(before, run);
        if is_same {
            before.end = run.end;
        }
        is_same
    });
    Ok((own, numbers.into_iter().collect()))
}
