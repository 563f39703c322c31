//! Pieces → parts: the components of a volume that is spread over processes, each whole on one.
//!
//! Every process scans its piece, and from then on only runs travel: a few per cent of the voxels.
//! It finds the components within its piece; the first process is told their sizes and the runs
//! beside other pieces, joins what touches, numbers the components of the whole volume, and deals
//! them out: each to one process, the largest first to the one that has least to do, where a surface
//! is made, and where a field is written to all in whose pieces it is. One that is worked on in tiles
//! (`tiles`) goes to all, as runs, so that each can number its parts. So no process ever holds
//! the volume or the whole mesh. What follows sees whole components and cannot tell that there were pieces.

use std::cmp::Reverse;
use std::collections::BTreeSet;

use crate::error::{check_count, collected, extend, filled, push, reserved, Error, Result};
use crate::execution::Execution;
use crate::fields::bricks;
use crate::grid::Grid;
use crate::processes::exchange::Team;
use crate::processes::territory::Territory;
use crate::reading::components::{
    connected, for_each_touch, parts, sort_by_label, DisjointSets, Part, SPECK,
};
use crate::reading::runs::{self, Run, Scan};
use crate::reading::volume::Volume;
use crate::reading::{report_full, report_specks, Wanted, READING};
use crate::Options;

/// Numbers that describe a component or a run to another process.
const COMPONENT_LENGTH: usize = 5;
const RUN_LENGTH: usize = 4;
/// Stands for the number of a component that is left out.
const LEFT_OUT: i64 = -1;

/// Who works on a component.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Share {
    /// One process; all of them where it has more voxels than this.
    One(usize),
    /// Every process near whose piece it is, as far as fields reach.
    Near,
}

/// The number of a component in the whole volume, or [`LEFT_OUT`], and who works on it.
#[derive(Debug, Clone, PartialEq)]
struct Decision {
    number: i64,
    workers: Vec<i64>,
}

/// The parts of the components that this process is to work on, numbered as in the whole volume.
pub(crate) fn gather_parts(
    piece: Option<&Volume>,
    whole: &Grid,
    options: &Options,
    share: Share,
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
    let near = match share {
        Share::One(_) => Vec::new(),
        Share::Near => found.near(&runs, &territory)?,
    };
    let most = match share {
        Share::One(most) => most,
        Share::Near => usize::MAX,
    };
    let decided = found.agree(&runs, (&near, most), &territory, voxels, team, execution)?;
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

    /// Pairs of a component and a process whose piece it reaches into, or nearly so.
    fn near(&self, runs: &[Run], territory: &Territory) -> Result<Vec<[i64; 2]>> {
        let mut near = Vec::new();
        for (run, &component) in runs.iter().zip(&self.of_run) {
            for process in territory.near(run, bricks::REACH) {
                push(&mut near, [component.into(), process as i64])?;
            }
        }
        near.sort_unstable();
        near.dedup();
        Ok(near)
    }

    /// What the first process decides for each component. `near` names processes that have to work
    /// on one; where there is none, one process is chosen, or all for more than `most` voxels.
    fn agree(
        &self,
        runs: &[Run],
        (near, most): (&[[i64; 2]], usize),
        territory: &Territory,
        voxels: usize,
        team: &mut Team,
        execution: &mut Execution,
    ) -> Result<Vec<Decision>> {
        let length = 2 + COMPONENT_LENGTH * self.components.len() + 2 * near.len();
        let mut message = reserved(length)?;
        message.extend([self.components.len() as i64, near.len() as i64]);
        for c in &self.components {
            message.extend([c.label, c.voxels, c.first[0], c.first[1], c.first[2]]);
        }
        message.extend(near.as_flattened());
        let beside = runs.iter().zip(&self.of_run);
        for (run, &component) in beside.filter(|(run, _)| territory.is_at_border(run)) {
            for number in pack(run, i64::from(component)) {
                push(&mut message, number)?;
            }
        }
        let of_all = team.gather(message)?;
        let answers = if team.is_first() {
            decide(&of_all, (voxels, most), team.processes(), execution)?
        } else {
            Vec::new()
        };
        let mut answers = team.swap(answers)?;
        read_decisions(&answers.swap_remove(crate::processes::exchange::FIRST))
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

/// What [`decide`] answers one process, component by component.
fn read_decisions(mut answer: &[i64]) -> Result<Vec<Decision>> {
    let mut decisions = Vec::new();
    while let Some((&[number, count], rest)) = answer.split_first_chunk::<2>() {
        let (workers, rest) = rest.split_at_checked(count as usize).ok_or(Error::Pieces)?;
        let workers = collected(workers.iter().copied())?;
        push(&mut decisions, Decision { number, workers })?;
        answer = rest;
    }
    Ok(decisions)
}

/// What all processes have told the first one.
#[derive(Default)]
struct Gathered {
    components: Vec<Component>,
    /// Runs beside other pieces, with their components.
    beside: Vec<(Run, u32)>,
    /// Components and processes near them.
    near: Vec<(usize, i64)>,
    /// Where the components of each process begin, and the end.
    starts: Vec<usize>,
}

impl Gathered {
    fn read(of_all: &[Vec<i64>]) -> Result<Self> {
        let mut all = Self {
            starts: vec![0],
            ..Self::default()
        };
        for message in of_all {
            let (&[count, near], rest) = message.split_first_chunk().ok_or(Error::Pieces)?;
            let described = COMPONENT_LENGTH * count as usize;
            let (described, rest) = rest.split_at_checked(described).ok_or(Error::Pieces)?;
            let near = 2 * near as usize;
            let (near, runs) = rest.split_at_checked(near).ok_or(Error::Pieces)?;
            let first = all.components.len();
            for c in described.chunks_exact(COMPONENT_LENGTH) {
                let component = Component {
                    label: c[0],
                    voxels: c[1],
                    first: [c[2], c[3], c[4]],
                };
                push(&mut all.components, component)?;
            }
            for pair in near.chunks_exact(2) {
                push(&mut all.near, (first + pair[0] as usize, pair[1]))?;
            }
            for numbers in runs.chunks_exact(RUN_LENGTH) {
                let (run, component) = unpack(numbers);
                push(&mut all.beside, (run, first as u32 + component as u32))?;
            }
            all.starts.push(all.components.len());
        }
        check_count("components", all.components.len(), 1)?;
        Ok(all)
    }
}

/// Joins the components of all pieces, and answers each process as [`LocalComponents::agree`] says.
fn decide(
    of_all: &[Vec<i64>],
    (voxels, most): (usize, usize),
    processes: usize,
    execution: &mut Execution,
) -> Result<Vec<Vec<i64>>> {
    let mut all = Gathered::read(of_all)?;
    let mut sets = join_across(&mut all.beside, all.components.len())?;
    let whole = join_components(&all.components, &mut sets)?;
    let mut decisions = number_and_deal(&whole, (voxels, most), processes, execution)?;
    let mut near = collected(all.near.iter().map(|&(c, process)| (sets.find(c), process)))?;
    near.sort_unstable();
    near.dedup();
    for of_component in near.chunk_by(|a, b| a.0 == b.0) {
        let workers = of_component.iter().map(|&(_, process)| process);
        decisions[of_component[0].0].workers = collected(workers)?;
    }
    let mut answers = Vec::new();
    for pair in all.starts.windows(2) {
        let mut answer = Vec::new();
        for component in pair[0]..pair[1] {
            let decision = &decisions[sets.find(component)];
            push(&mut answer, decision.number)?;
            push(&mut answer, decision.workers.len() as i64)?;
            extend(&mut answer, decision.workers.iter().copied())?;
        }
        answers.push(answer);
    }
    Ok(answers)
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

/// The components that `sets` make of those of all pieces, where their roots are.
fn join_components(
    components: &[Component],
    sets: &mut DisjointSets,
) -> Result<Vec<Option<Component>>> {
    let mut whole: Vec<Option<Component>> = filled(None, components.len())?;
    for (i, c) in components.iter().enumerate() {
        let joined = whole[sets.find(i)].get_or_insert(Component { voxels: 0, ..*c });
        joined.voxels += c.voxels;
        joined.first = joined.first.min(c.first);
    }
    Ok(whole)
}

/// Numbers the joined components by label, then by size, the largest first, then by place, and
/// gives the largest first to the process with the fewest voxels so far. Those of more than `most` go to
/// all.
fn number_and_deal(
    whole: &[Option<Component>],
    (voxels, most): (usize, usize),
    processes: usize,
    execution: &mut Execution,
) -> Result<Vec<Decision>> {
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
    let left_out = Decision {
        number: LEFT_OUT,
        workers: Vec::new(),
    };
    let mut decisions = filled(left_out, whole.len())?;
    for (number, (root, c)) in order.iter().enumerate() {
        if c.voxels as usize == voxels {
            report_full(execution);
        } else {
            decisions[*root].number = number as i64;
        }
    }
    report_specks(specks, execution);
    order.sort_unstable_by_key(|(i, c)| (Reverse(c.voxels), c.label, c.first, *i));
    let mut load = vec![0; processes];
    for (root, c) in &order {
        if c.voxels as usize > most {
            decisions[*root].workers = collected(0..processes as i64)?;
            load.iter_mut()
                .for_each(|load| *load += c.voxels / processes as i64);
            continue;
        }
        let owner = (0..processes).min_by_key(|&p| load[p]).unwrap_or(0);
        load[owner] += c.voxels;
        decisions[*root].workers = vec![owner as i64];
    }
    Ok(decisions)
}

/// Sends every run to those who work on its component. Returns the runs of the own components, in
/// order, and the numbers of these, ascending.
fn deal_out(
    runs: &[Run],
    found: &LocalComponents,
    decided: &[Decision],
    team: &mut Team,
) -> Result<(Vec<Run>, Vec<u32>)> {
    let mut messages = vec![Vec::new(); team.processes()];
    for (run, &component) in runs.iter().zip(&found.of_run) {
        let Decision { number, workers } = &decided[component as usize];
        if *number == LEFT_OUT {
            continue;
        }
        for &worker in workers {
            extend(&mut messages[worker as usize], pack(run, *number))?;
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
