//! A volume that is spread over processes gives what it gives as a whole.

use midsurface::{
    extract, extract_piece, mid_polylines, mid_polylines_piece, ridge_field, ridge_field_piece,
    statistics, statistics_of_pieces, zip_polylines, zip_polylines_piece, Error, Grid, Mesh,
    MeshPiece, Method, Observer, Options, Polylines, Result, Statistics, TriangleMesh, Volume,
};
use ndarray::{s, Array3};
use phantoms::*;
use proptest::prelude::*;

use crate::channels::{connect, Channels};
use crate::observer::Recorder;

/// Voxels from .. to along x, y, z; nothing where from is not below to.
type Extent = [[usize; 3]; 2];

/// The voxels of `extent`, and where they lie.
fn cut(labels: &[u8], whole: &Grid, [from, to]: Extent) -> Option<(Vec<u8>, Grid)> {
    if (0..3).any(|a| from[a] >= to[a]) {
        return None;
    }
    let [nx, ny, _] = whole.dimensions;
    let rows = (from[2]..to[2]).flat_map(|z| (from[1]..to[1]).map(move |y| (z * ny + y) * nx));
    let piece = rows.flat_map(|row| labels[row + from[0]..row + to[0]].iter().copied());
    let grid = Grid {
        dimensions: std::array::from_fn(|a| to[a] - from[a]),
        extent_start: std::array::from_fn(|a| whole.extent_start[a] + from[a] as i64),
        ..whole.clone()
    };
    Some((piece.collect(), grid))
}

/// What the function of a process is called with.
struct Call<'a> {
    piece: Option<&'a Volume<'a>>,
    end: &'a mut Channels,
    observer: &'a mut Recorder,
}

/// What `work` makes of the piece in each process, and what it tells.
fn in_processes<T: Send>(
    labels: &[u8],
    whole: &Grid,
    pieces: &[Extent],
    cancel: impl Fn(usize) -> usize + Sync,
    work: impl Fn(Call) -> Result<T> + Sync,
) -> Vec<(Result<T>, Vec<String>)> {
    let ends = connect(pieces.len());
    let work = |mut end: Channels, extent: Extent| {
        let mut recorder = Recorder::new(cancel(end.process));
        let piece = cut(labels, whole, extent);
        let volume = piece
            .as_ref()
            .map(|(labels, grid)| Volume::new(labels, grid.clone()).expect("a piece"));
        let result = work(Call {
            piece: volume.as_ref(),
            end: &mut end,
            observer: &mut recorder,
        });
        (result, recorder.warnings)
    };
    let work = &work;
    std::thread::scope(|scope| {
        let start = |(end, &extent)| scope.spawn(move || work(end, extent));
        let threads: Vec<_> = ends.into_iter().zip(pieces).map(start).collect();
        let outcomes = threads.into_iter().map(|thread| thread.join());
        outcomes.map(|outcome| outcome.expect("no panic")).collect()
    })
}

/// The mesh of each process.
fn run(
    labels: &[u8],
    whole: &Grid,
    pieces: &[Extent],
    options: &Options,
    cancel: impl Fn(usize) -> usize + Sync,
) -> Vec<(Result<MeshPiece>, Vec<String>)> {
    in_processes(labels, whole, pieces, cancel, |call| {
        extract_piece(call.piece, whole, options, call.end, call.observer)
    })
}

fn never(_: usize) -> usize {
    usize::MAX
}

/// Blocks of points of which neighbours share so many layers.
fn blocks(dimensions: [usize; 3], counts: [usize; 3], shared: usize) -> Vec<Extent> {
    let cut = |axis: usize, i: usize| (dimensions[axis] - 1) * i / counts[axis];
    let mut blocks = Vec::new();
    for z in 0..counts[2] {
        for y in 0..counts[1] {
            for x in 0..counts[0] {
                let at = [x, y, z];
                let to = |a: usize| match at[a] + 1 == counts[a] {
                    true => dimensions[a],
                    false => (cut(a, at[a] + 1) + shared).min(dimensions[a]),
                };
                blocks.push([
                    std::array::from_fn(|a| cut(a, at[a])),
                    std::array::from_fn(to),
                ]);
            }
        }
    }
    blocks
}

/// The bits of a triangle's corners with their normals and thickness, and its label and component.
type Triangle = (i64, u32, Vec<u32>);

/// The triangles of meshes, whatever the order of points and triangles.
fn triangles<'a>(meshes: impl IntoIterator<Item = &'a Mesh>) -> Vec<Triangle> {
    let mut all = Vec::new();
    for mesh in meshes {
        for (t, triangle) in mesh.triangles.iter().enumerate() {
            let corner = |p: u32| {
                let p = p as usize;
                let floats = mesh.points[p].into_iter().chain(mesh.normals[p]);
                floats.chain([mesh.thickness[p]]).map(f32::to_bits)
            };
            let corners = triangle.iter().flat_map(|&p| corner(p)).collect();
            all.push((mesh.labels[t], mesh.components[t], corners));
        }
    }
    all.sort();
    all
}

/// Runs `labels` whole and in pieces, and compares meshes and warnings.
fn compare(labels: &[u8], whole: &Grid, pieces: &[Extent], options: &Options) -> Vec<Mesh> {
    let volume = Volume::new(labels, whole.clone()).expect("a volume");
    let mut recorder = Recorder::new(usize::MAX);
    let expected = extract(&volume, options, &mut recorder);
    let outcomes = run(labels, whole, pieces, options, never);
    let mut meshes = Vec::new();
    for (process, (outcome, warnings)) in outcomes.into_iter().enumerate() {
        match outcome {
            Ok(piece) => {
                let before = |count: fn(&Mesh) -> usize| meshes.iter().map(count).sum::<usize>();
                let first = before(|m| m.points.len()) as i64;
                let ids = first..first + piece.mesh.points.len() as i64;
                assert_eq!(piece.point_ids, ids.collect::<Vec<_>>());
                assert_eq!(piece.first_triangle as usize, before(|m| m.triangles.len()));
                meshes.push(piece.mesh);
            }
            Err(error) => assert!(expected.is_err(), "process {process}: {error}"),
        }
        if process == 0 {
            let sorted = |mut texts: Vec<String>| {
                texts.sort();
                texts
            };
            assert_eq!(sorted(warnings), sorted(recorder.warnings.clone()));
        } else {
            assert_eq!(warnings, Vec::<String>::new(), "process {process}");
        }
    }
    if let Ok(mesh) = &expected {
        assert_eq!(meshes.len(), pieces.len());
        for mesh in &meshes {
            mesh.check_invariants().expect("a sound mesh");
        }
        let points: usize = meshes.iter().map(|mesh| mesh.points.len()).sum();
        assert_eq!(points, mesh.points.len());
        assert_eq!(triangles(&meshes), triangles([mesh]));
    }
    meshes
}

fn options(method: Method) -> Options {
    Options {
        method,
        threads: 1,
        ..Options::default()
    }
}

#[test]
fn any_number_of_pieces_gives_the_mesh_of_the_whole() {
    let dimensions = [96, 72, 40];
    let labels = mitochondrion(dimensions, 0.05, 11);
    let whole = Grid {
        extent_start: [-5, 0, 7],
        spacing: [1.0, 1.0, 1.3],
        origin: [100.0, 2.0, 3.0],
        ..Grid::new(dimensions)
    };
    for method in [Method::RidgeSurface, Method::PolylineZipper] {
        for counts in [[1, 1, 1], [2, 1, 1], [1, 1, 3], [2, 2, 1], [7, 1, 1]] {
            let pieces = blocks(dimensions, counts, 1);
            let meshes = compare(&labels, &whole, &pieces, &options(method));
            let busy = meshes.iter().filter(|mesh| !mesh.triangles.is_empty());
            assert!(busy.count() >= pieces.len().min(2), "one does all the work");
        }
    }
}

/// A line's label, component and slice, whether it is closed, and the bits of its points.
type Line = (i64, u32, i64, bool, Vec<u64>);

/// The lines of all, whatever their order.
fn lines<'a>(all: impl IntoIterator<Item = &'a Polylines>) -> Vec<Line> {
    let mut found = Vec::new();
    for polylines in all {
        for line in &polylines.lines {
            let bits = (line.first..line.first + line.count).flat_map(|p| {
                let [thick, border] =
                    [&polylines.thickness, &polylines.border_distance].map(|a| f64::from(a[p]));
                let point = polylines.points[p].into_iter();
                point.chain([thick, border]).map(f64::to_bits)
            });
            let bits = bits.collect();
            found.push((line.label, line.component, line.slice, line.closed, bits));
        }
    }
    found.sort();
    found
}

#[test]
fn lines_of_pieces_are_those_of_the_whole_and_are_zipped_to_its_mesh() {
    let dimensions = [96, 72, 40];
    let labels = mitochondrion(dimensions, 0.05, 11);
    let whole = &Grid::new(dimensions);
    let options = &options(Method::PolylineZipper);
    let volume = Volume::new(&labels, whole.clone()).expect("a volume");
    let mut recorder = Recorder::new(usize::MAX);
    let expected = mid_polylines(&volume, options, &mut recorder).expect("lines");
    let mesh = zip_polylines(&expected, options, &mut Recorder::new(usize::MAX)).expect("a mesh");
    for counts in [[2, 1, 1], [1, 1, 3], [2, 2, 1]] {
        let pieces = blocks(dimensions, counts, 1);
        let outcomes = in_processes(&labels, whole, &pieces, never, |call| {
            let (end, observer) = (call.end, call.observer);
            let lines = mid_polylines_piece(call.piece, whole, options, end, observer)?;
            let mesh = zip_polylines_piece(&lines, options, end, &mut Recorder::new(usize::MAX))?;
            Ok((lines, mesh.mesh))
        });
        assert_eq!(outcomes[0].1, recorder.warnings);
        let outcomes = outcomes.into_iter().map(|(result, _)| result);
        let (found, meshes): (Vec<_>, Vec<_>) = outcomes.map(|r| r.expect("lines")).unzip();
        assert_eq!(lines(&found), lines([&expected]));
        assert_eq!(triangles(&meshes), triangles([&mesh]));
    }
}

#[test]
fn lines_of_a_component_on_several_processes_are_refused_by_all() {
    let dimensions = [40, 36, 32];
    let labels = mitochondrion(dimensions, 0.0, 1);
    let whole = &Grid::new(dimensions);
    let options = &options(Method::PolylineZipper);
    let volume = Volume::new(&labels, whole.clone()).expect("a volume");
    let mut recorder = Recorder::new(usize::MAX);
    let same = &mid_polylines(&volume, options, &mut recorder).expect("lines");
    let nothing = [[[0; 3]; 2]; 2];
    for (outcome, _) in in_processes(&labels, whole, &nothing, never, |call| {
        zip_polylines_piece(same, options, call.end, call.observer)
    }) {
        let error = outcome.expect_err("refused").to_string();
        assert!(
            error.contains("several processes have lines of component 0"),
            "{error}"
        );
    }
}

#[test]
fn fields_of_pieces_are_those_of_the_whole() {
    let dimensions = [96, 72, 40];
    let labels = mitochondrion(dimensions, 0.05, 11);
    let whole = &Grid {
        extent_start: [-5, 0, 7],
        spacing: [1.0, 1.0, 1.3],
        ..Grid::new(dimensions)
    };
    let options = &options(Method::PolylineZipper);
    let volume = Volume::new(&labels, whole.clone()).expect("a volume");
    let mut observer = Recorder::new(usize::MAX);
    let of = |[x, y, z]: [usize; 3]| [Array3::<f32>::zeros((z, y, x)), Array3::zeros((z, y, x))];
    let [mut distance, mut ridge] = of(dimensions);
    let (d, r) = (distance.view_mut(), ridge.view_mut());
    ridge_field(&volume, options, &mut observer, d, r).expect("fields");
    for (counts, shared) in [
        ([2, 1, 1], 1),
        ([1, 1, 3], 0),
        ([2, 2, 1], 2),
        ([7, 1, 1], 1),
    ] {
        let pieces = blocks(dimensions, counts, shared);
        let outcomes = in_processes(&labels, whole, &pieces, never, |call| {
            let [mut distance, mut ridge] =
                of(call.piece.map_or([0; 3], |piece| piece.grid().dimensions));
            let (d, r) = (distance.view_mut(), ridge.view_mut());
            ridge_field_piece(call.piece, whole, options, call.end, call.observer, d, r)?;
            Ok([distance, ridge])
        });
        for ((outcome, _), [from, to]) in outcomes.into_iter().zip(pieces) {
            let part = s![from[2]..to[2], from[1]..to[1], from[0]..to[0]];
            let found = outcome.expect("fields");
            assert_eq!(found, [distance.slice(part), ridge.slice(part)]);
        }
    }
}

#[test]
fn processes_that_are_told_different_things_are_refused() {
    let dimensions = [40, 36, 32];
    let labels = mitochondrion(dimensions, 0.0, 1);
    let whole = &Grid::new(dimensions);
    let pieces = blocks(dimensions, [3, 1, 1], 1);
    let of_one = [
        options(Method::PolylineZipper),
        Options {
            edge_length: 3.0,
            ..options(Method::RidgeSurface)
        },
        Options {
            labels: Some(vec![1]),
            ..options(Method::RidgeSurface)
        },
    ];
    for different in &of_one {
        for (outcome, _) in in_processes(&labels, whole, &pieces, never, |call| {
            let own = match call.end.process {
                1 => different.clone(),
                _ => options(Method::RidgeSurface),
            };
            extract_piece(call.piece, whole, &own, call.end, call.observer)
        }) {
            assert_eq!(outcome, Err(Error::OptionsDiffer));
        }
    }
}

/// The table of a mesh, or of a piece of one.
fn measure(mesh: &Mesh, ids: Option<&[i64]>, exchange: Option<&mut Channels>) -> Vec<Statistics> {
    let points: Vec<_> = mesh.points.iter().map(|p| p.map(f64::from)).collect();
    let triangles: Vec<_> = mesh.triangles.iter().map(|t| t.map(i64::from)).collect();
    let components: Vec<_> = mesh.components.iter().copied().map(i64::from).collect();
    let mesh = TriangleMesh {
        points: &points,
        triangles: &triangles,
        thickness: Some(&mesh.thickness),
        labels: Some(&mesh.labels),
        components: Some(&components),
        point_ids: ids,
    };
    let table = match exchange {
        None => statistics(&mesh),
        Some(exchange) => statistics_of_pieces(&mesh, exchange),
    };
    table.expect("a table")
}

#[test]
fn the_table_of_all_pieces_is_that_of_the_whole() {
    let dimensions = [96, 72, 40];
    let labels = mitochondrion(dimensions, 0.05, 11);
    let whole = Grid::new(dimensions);
    let options = options(Method::RidgeSurface);
    let volume = Volume::new(&labels, whole.clone()).expect("a volume");
    let mesh = extract(&volume, &options, &mut Recorder::new(usize::MAX)).expect("a mesh");
    let pieces = compare(&labels, &whole, &blocks(dimensions, [3, 1, 1], 1), &options);
    check_table(pieces.iter().map(|piece| (piece, None)), &mesh);
}

/// The triangles of a mesh that are wanted, with their points and the numbers of these.
fn part(mesh: &Mesh, is_wanted: impl Fn(usize) -> bool) -> (Mesh, Vec<i64>) {
    let (mut part, mut ids) = (Mesh::default(), Vec::new());
    for t in (0..mesh.triangles.len()).filter(|&t| is_wanted(t)) {
        part.triangles.push(mesh.triangles[t].map(|p| {
            let known = ids.iter().rposition(|id| *id == i64::from(p));
            known.unwrap_or_else(|| {
                ids.push(i64::from(p));
                ids.len() - 1
            }) as u32
        }));
        part.labels.push(mesh.labels[t]);
        part.components.push(mesh.components[t]);
    }
    let points = ids.iter().map(|&id| id as usize);
    part.points = points.clone().map(|p| mesh.points[p]).collect();
    part.thickness = points.map(|p| mesh.thickness[p]).collect();
    (part, ids)
}

#[test]
fn components_of_several_processes_are_measured_as_wholes() {
    let dimensions = [40, 36, 32];
    let labels = mitochondrion(dimensions, 0.0, 1);
    let volume = Volume::new(&labels, Grid::new(dimensions)).expect("a volume");
    let options = options(Method::RidgeSurface);
    let mesh = extract(&volume, &options, &mut Recorder::new(usize::MAX)).expect("a mesh");
    let place = |t: usize| mesh.points[mesh.triangles[t][0] as usize];
    // In the middle a process that has nothing; the others' triangles are mixed.
    let whose = |t: usize| match place(t)[0] as usize + place(t)[2] as usize {
        sum if sum % 9 < 4 => 0,
        sum if sum < 36 => 2,
        _ => 3,
    };
    let parts: Vec<_> = (0..4)
        .map(|process| part(&mesh, |t| whose(t) == process))
        .collect();
    assert!(parts[1].0.triangles.is_empty());
    check_table(
        parts.iter().map(|(part, ids)| (part, Some(&ids[..]))),
        &mesh,
    );
}

/// Compares the table of pieces, with the numbers of their points, with that of the whole.
fn check_table<'a>(pieces: impl Iterator<Item = (&'a Mesh, Option<&'a [i64]>)>, mesh: &Mesh) {
    let pieces: Vec<_> = pieces.collect();
    let tables: Vec<Vec<Statistics>> = std::thread::scope(|scope| {
        let threads: Vec<_> = connect(pieces.len())
            .into_iter()
            .zip(pieces)
            .map(|(mut end, (piece, ids))| scope.spawn(move || measure(piece, ids, Some(&mut end))))
            .collect();
        let tables = threads.into_iter().map(|thread| thread.join());
        tables.map(|table| table.expect("no panic")).collect()
    });
    assert!(tables[1..].iter().all(Vec::is_empty));
    // To the bit.
    assert_eq!(tables[0], measure(mesh, None, None));
}

#[test]
fn the_whole_on_one_process_or_on_all_is_the_whole() {
    let dimensions = [40, 36, 32];
    let labels = mitochondrion(dimensions, 0.0, 1);
    let whole = Grid::new(dimensions);
    let all = [[0; 3], dimensions];
    for pieces in [[[[0; 3]; 2], all, [[0; 3]; 2]], [all; 3]] {
        compare(&labels, &whole, &pieces, &options(Method::RidgeSurface));
    }
}

#[test]
fn pieces_that_leave_something_out_are_refused_by_all() {
    let dimensions = [12, 10, 8];
    let whole = Grid::new(dimensions);
    let labels = vec![0; 12 * 10 * 8];
    let hole = [[[0; 3], [12, 10, 4]], [[0, 0, 5], dimensions]];
    for (outcome, _) in run(&labels, &whole, &hole, &Options::default(), never) {
        assert_eq!(outcome, Err(Error::Pieces));
    }
}

#[test]
fn what_fails_in_one_process_fails_in_all() {
    let dimensions = [48, 20, 20];
    let whole = Grid::new(dimensions);
    let labels = mitochondrion(dimensions, 0.0, 3);
    let pieces = blocks(dimensions, [3, 1, 1], 1);
    let absent = Options {
        labels: Some(vec![77]),
        ..Options::default()
    };
    let outcomes = run(&labels, &whole, &pieces, &absent, never);
    assert!(matches!(outcomes[0].0, Err(Error::LabelsAbsent { .. })));
    for (outcome, _) in &outcomes[1..] {
        let error = outcome.as_ref().expect_err("refused").to_string();
        assert!(
            error.starts_with("process 0 failed: none of the labels"),
            "{error}"
        );
    }
}

#[test]
fn a_cancel_in_one_process_ends_all() {
    let dimensions = [48, 40, 36];
    let whole = Grid::new(dimensions);
    let labels = mitochondrion(dimensions, 0.0, 3);
    let pieces = blocks(dimensions, [3, 1, 1], 1);
    for process in 0..3 {
        for call in [0, 1, 2, 3, 5, 8, 13, 21] {
            let cancel = |p: usize| if p == process { call } else { usize::MAX };
            for (outcome, _) in run(&labels, &whole, &pieces, &Options::default(), cancel) {
                assert_eq!(
                    outcome,
                    Err(Error::Cancelled),
                    "process {process}, call {call}"
                );
            }
        }
    }
}

#[test]
fn a_panic_in_one_process_ends_all() {
    struct Panicking(usize);
    impl Observer for Panicking {
        fn progress(&mut self, _: f64, _: &str) -> bool {
            assert_ne!(self.0, 0, "a panic on purpose");
            self.0 -= 1;
            true
        }
        fn warning(&mut self, _: &str) {}
    }
    let dimensions = [48, 40, 36];
    let labels = mitochondrion(dimensions, 0.0, 3);
    let volume = Volume::new(&labels, Grid::new(dimensions)).expect("a volume");
    for calls in [0, 2, 9] {
        std::thread::scope(|scope| {
            let volume = &volume;
            let work = |mut end: Channels| {
                let calls = if end.process == 1 { calls } else { usize::MAX };
                let grid = volume.grid();
                let (options, mut observer) = (Options::default(), Panicking(calls));
                extract_piece(Some(volume), grid, &options, &mut end, &mut observer)
            };
            let threads: Vec<_> = connect(3)
                .into_iter()
                .map(|end| scope.spawn(move || work(end)))
                .collect();
            for (process, thread) in threads.into_iter().enumerate() {
                match thread.join() {
                    Ok(outcome) => {
                        let message = "internal error".to_owned();
                        let expected = Error::Elsewhere {
                            process: 1,
                            message,
                        };
                        assert_eq!(outcome, Err(expected), "process {process}");
                    }
                    Err(_) => assert_eq!(process, 1),
                }
            }
        });
    }
}

/// Random labels in lumps, so that there are components of all sizes.
fn lumps(dimensions: [usize; 3]) -> impl Strategy<Value = Vec<u8>> {
    let extent = |axis: usize| (0..dimensions[axis], 1..7usize);
    let lump = (extent(0), extent(1), extent(2), 0..4u8);
    prop::collection::vec(lump, 1..40).prop_map(move |lumps| {
        let [nx, ny, nz] = dimensions;
        let mut labels = vec![0; nx * ny * nz];
        for ((x, wide), (y, high), (z, deep), label) in lumps {
            for z in z..(z + deep).min(nz) {
                for y in y..(y + high).min(ny) {
                    let row = (z * ny + y) * nx;
                    labels[row + x..row + (x + wide).min(nx)].fill(label);
                }
            }
        }
        labels
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 150, ..ProptestConfig::default() })]

    #[test]
    fn random_volumes_in_random_pieces(
        labels in lumps([26, 22, 18]),
        counts in [1..4usize, 1..4usize, 1..3usize],
        shared in 0..3usize,
        zipper in any::<bool>(),
    ) {
        let dimensions = [26, 22, 18];
        let method = if zipper { Method::PolylineZipper } else { Method::RidgeSurface };
        let pieces = blocks(dimensions, counts, shared);
        compare(&labels, &Grid::new(dimensions), &pieces, &options(method));
    }

    #[test]
    fn random_triangles_of_random_processes_have_the_table_of_all(
        triangles in prop::collection::vec(([0..9u32, 0..9u32, 0..9u32], 0..3usize, 0..3u32), 0..40),
        places in prop::collection::vec([-1.0..1.0f32, -1.0..1.0f32, -1.0..1.0f32], 9),
    ) {
        let is_triangle = |[a, b, c]: [u32; 3]| a != b && b != c && c != a;
        let triangles: Vec<_> = triangles.into_iter().filter(|t| is_triangle(t.0)).collect();
        let mesh = Mesh {
            thickness: places.iter().map(|p| if p[0] < 0.8 { p[1] } else { f32::NAN }).collect(),
            points: places,
            triangles: triangles.iter().map(|t| t.0).collect(),
            labels: triangles.iter().map(|t| i64::from(t.2 / 2)).collect(),
            components: triangles.iter().map(|t| t.2).collect(),
            ..Mesh::default()
        };
        let parts: Vec<_> = (0..3)
            .map(|process| part(&mesh, |t| triangles[t].1 == process))
            .collect();
        let with_ids = parts.iter().map(|(part, ids)| (part, Some(&ids[..])));
        check_table(with_ids, &mesh);
    }
}
