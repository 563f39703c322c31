//! Random images through the VTK filter: the mesh is sound, and the same to the bit as that of the
//! library called directly; where the library refuses, so does the filter, with a message.

use cxx::let_cxx_string;
use midsurface::{extract, Error, Grid, Mesh, Method, Options, Quiet, Volume};
use midsurface_filter_tests::bridge::{filter, FilterBridge};
use proptest::prelude::*;

/// How values of a VTK type lie in memory.
type Bytes = fn(i64) -> Vec<u8>;

/// VTK's number for each numeric type (vtkType.h), and whether it has a sign.
const TYPES: [(i32, bool, Bytes); 14] = [
    (2, true, |v| (v as i8).to_ne_bytes().to_vec()), // char, signed here
    (3, false, |v| (v as u8).to_ne_bytes().to_vec()), // unsigned char
    (4, true, |v| (v as i16).to_ne_bytes().to_vec()), // short
    (5, false, |v| (v as u16).to_ne_bytes().to_vec()), // unsigned short
    (6, true, |v| (v as i32).to_ne_bytes().to_vec()), // int
    (7, false, |v| (v as u32).to_ne_bytes().to_vec()), // unsigned int
    (8, true, |v| v.to_ne_bytes().to_vec()),         // long
    (9, false, |v| v.to_ne_bytes().to_vec()),        // unsigned long
    (10, true, |v| (v as f32).to_ne_bytes().to_vec()), // float
    (11, true, |v| (v as f64).to_ne_bytes().to_vec()), // double
    (12, true, |v| v.to_ne_bytes().to_vec()),        // vtkIdType
    (15, true, |v| (v as i8).to_ne_bytes().to_vec()), // signed char
    (16, true, |v| v.to_ne_bytes().to_vec()),        // long long
    (17, false, |v| v.to_ne_bytes().to_vec()),       // unsigned long long
];

#[derive(Debug, Clone)]
struct Case {
    /// Where the voxels lie, on points: with cells, they are the cells between one more point.
    grid: Grid,
    labels: Vec<i64>,
    on_cells: bool,
    /// Cells of an axis with a single one lie on a single point.
    is_thin: bool,
    scalar_type: usize,
    components: usize,
    method: Method,
    edge_length: f64,
    wanted: Vec<i64>,
    threshold: Option<f64>,
    threads: usize,
}

/// The same for each axis.
fn three<S: Clone>(one: S) -> [S; 3] {
    [one.clone(), one.clone(), one]
}

/// The image's axes in the world: along its own, mirrored, turned, or askew.
fn directions() -> impl Strategy<Value = [[f64; 3]; 3]> {
    let turned = (0.0..6.3f64).prop_map(|angle| {
        let (sin, cos) = angle.sin_cos();
        [[cos, -sin, 0.0], [0.0, 0.0, 1.0], [sin, cos, 0.0]]
    });
    prop_oneof![
        Just([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]),
        Just([[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]),
        turned,
        Just([[1.0, 0.4, 0.0], [0.0, 0.9, 0.1], [0.2, 0.0, 1.1]]),
    ]
}

fn grids() -> impl Strategy<Value = Grid> {
    let spacing = prop_oneof![Just([1.0; 3]), three(0.3..3.0f64), three(1e-8..3e-8f64)];
    let place = (
        three(-9..9i64),
        spacing,
        three(-50.0..50.0f64),
        directions(),
    );
    (three(1..=14usize), place).prop_map(|(dimensions, place)| {
        let (extent_start, spacing, origin, direction) = place;
        Grid {
            dimensions,
            extent_start,
            spacing,
            origin,
            direction,
        }
    })
}

/// Boxes painted over each other, some with background, or thin curved sheets.
fn labels(grid: &Grid) -> BoxedStrategy<Vec<i64>> {
    let [nx, ny, nz] = grid.dimensions;
    let at = move |i: usize| [i % nx, i / nx % ny, i / (nx * ny)];
    let side = |n: usize| (0..n, 1..=n);
    let label = prop::sample::select(vec![1i64, 1, 2, 100, 0]);
    let one = (side(nx), side(ny), side(nz), label);
    let boxes = prop::collection::vec(one, 0..8).prop_map(move |boxes| {
        let label = |i: usize| {
            let is_within = |v: usize, (from, count): (usize, usize)| v >= from && v - from < count;
            let [x, y, z] = at(i);
            let is_in = |&(a, b, c, _): &_| is_within(x, a) && is_within(y, b) && is_within(z, c);
            boxes
                .iter()
                .rev()
                .find(|one| is_in(one))
                .map_or(0, |one| one.3)
        };
        (0..nx * ny * nz).map(label).collect()
    });
    let wave = || [-1.0..1.0f64, -1.0..1.0, -1.0..1.0, 0.0..6.3];
    let sheets = (three(wave()), 0.1..0.9f64).prop_map(move |(waves, width)| {
        let label = |i: usize| {
            let p = at(i).map(|v| v as f64);
            let phase = |w: &[f64; 4]| w[0] * p[0] + w[1] * p[1] + w[2] * p[2] + w[3];
            i64::from(waves.iter().map(|w| phase(w).sin()).sum::<f64>().abs() < width)
        };
        (0..nx * ny * nz).map(label).collect()
    });
    prop_oneof![boxes, sheets].boxed()
}

fn cases() -> impl Strategy<Value = Case> {
    let volumes = grids().prop_flat_map(|grid| (labels(&grid), Just(grid)));
    let array = (
        any::<bool>(),
        any::<bool>(),
        0..TYPES.len(),
        prop::sample::select(vec![1usize, 1, 1, 1, 1, 1, 1, 1, 1, 3]),
    );
    let edge_length = prop_oneof![Just(0.0), Just(0.0), 0.7..5.0f64, Just(-1.0)];
    let options = (
        prop::sample::select(vec![Method::RidgeSurface, Method::PolylineZipper]),
        edge_length,
        prop_oneof![
            Just(vec![]),
            Just(vec![]),
            prop::sample::subsequence(vec![1i64, 2, 100], 1..3)
        ],
        prop::option::weighted(0.2, -0.5..2.5f64),
        0..3usize,
    );
    (volumes, array, options).prop_map(|((labels, grid), array, options)| {
        let (on_cells, is_thin, scalar_type, components) = array;
        let (method, edge_length, wanted, threshold, threads) = options;
        // A length in the image's units.
        let edge_length = edge_length * grid.unit();
        Case {
            grid,
            labels,
            on_cells,
            is_thin,
            scalar_type,
            components,
            method,
            edge_length,
            wanted,
            threshold,
            threads,
        }
    })
}

impl Case {
    /// Whether the axis has one point more than voxels.
    fn is_between_points(&self, axis: usize) -> bool {
        self.on_cells && !(self.is_thin && self.grid.dimensions[axis] == 1)
    }

    /// The values as this case's type; where that has a sign, label 2 is -2.
    fn values(&self) -> Vec<i64> {
        let two = if TYPES[self.scalar_type].1 { -2 } else { 2 };
        let value = |&label: &i64| if label == 2 { two } else { label };
        self.labels.iter().map(value).collect()
    }

    fn wanted(&self) -> Vec<i64> {
        let two = if TYPES[self.scalar_type].1 { -2 } else { 2 };
        let value = |&label: &i64| if label == 2 { two } else { label };
        self.wanted.iter().map(value).collect()
    }

    /// The library's answer and its warnings.
    fn directly(&self) -> (Result<Mesh, Error>, Vec<String>) {
        let mut grid = self.grid.clone();
        for axis in (0..3).filter(|&axis| self.is_between_points(axis)) {
            for row in 0..3 {
                grid.origin[row] += grid.direction[row][axis] * 0.5 * grid.spacing[axis];
            }
        }
        let wanted = self.wanted();
        let options = Options {
            method: self.method,
            labels: (!wanted.is_empty()).then_some(wanted),
            threads: self.threads,
            edge_length: self.edge_length,
        };
        let values = self.values();
        let mut observer = Quiet::default();
        let mesh = Volume::new(&values, grid)
            .and_then(|volume| match self.threshold {
                Some(threshold) => volume.with_threshold(threshold),
                None => Ok(volume),
            })
            .and_then(|volume| extract(&volume, &options, &mut observer));
        (mesh, observer.warnings)
    }

    fn filter(&self) -> cxx::UniquePtr<FilterBridge> {
        let filter = filter();
        let start = self.grid.extent_start.map(|v| v as i32);
        let mut extent = [0; 6];
        for axis in 0..3 {
            let more = i32::from(self.is_between_points(axis)) - 1;
            extent[2 * axis] = start[axis];
            extent[2 * axis + 1] = start[axis] + self.grid.dimensions[axis] as i32 + more;
        }
        let Grid {
            spacing,
            origin,
            direction: [a, b, c],
            ..
        } = &self.grid;
        let direction = [a[0], a[1], a[2], b[0], b[1], b[2], c[0], c[1], c[2]];
        filter.set_frame(&extent, spacing, origin, &direction);
        let (vtk_type, _, bytes) = TYPES[self.scalar_type];
        let values = self.values();
        let repeated = values
            .iter()
            .flat_map(|&v| bytes(v).repeat(self.components));
        let scalars: Vec<u8> = repeated.collect();
        let components = self.components as i32;
        // SAFETY: as many bytes as the length says.
        unsafe {
            let (bytes, size) = (scalars.as_ptr(), scalars.len());
            let added = filter.add_array(vtk_type, components, bytes, size, self.on_cells);
            added.expect("whole values");
        }
        filter.set_method(i32::from(self.method == Method::RidgeSurface));
        filter.set_edge_length(self.edge_length);
        filter.set_threads(self.threads as i32);
        if let Some(threshold) = self.threshold {
            filter.set_threshold(threshold);
        }
        for label in self.wanted() {
            filter.choose_label(label);
        }
        filter
    }
}

fn triples<T: Copy>(values: &[T]) -> Vec<[T; 3]> {
    values.chunks_exact(3).map(|v| [v[0], v[1], v[2]]).collect()
}

/// What the filter has made.
fn mesh_of(filter: &FilterBridge) -> Mesh {
    let point_array = |name: &str| {
        let_cxx_string!(name = name);
        filter.point_array(&name).as_slice().to_vec()
    };
    let cell_array = |name: &str| {
        let_cxx_string!(name = name);
        filter.cell_array(&name).as_slice().to_vec()
    };
    let narrow = |v: i64| u32::try_from(v).expect("an index");
    let triangles = triples(filter.triangles().as_slice());
    let components = cell_array("Component");
    Mesh {
        points: triples(filter.points().as_slice()),
        triangles: triangles.into_iter().map(|t| t.map(narrow)).collect(),
        normals: triples(&point_array("Normals")),
        thickness: point_array("Thickness"),
        labels: cell_array("Label"),
        components: components.into_iter().map(narrow).collect(),
    }
}

fn check(case: &Case) {
    let filter = case.filter();
    let succeeded = filter.update();
    let errors = filter.errors().to_string_lossy();
    let mesh = mesh_of(&filter);
    mesh.check_invariants().expect("a sound mesh");
    let (expected, warnings) = case.directly();
    if case.components != 1 {
        assert!(!succeeded && errors.contains("components"), "{errors}");
        assert!(mesh.triangles.is_empty());
        return;
    }
    // What the library only warns of, the filter refuses: a label asked for that is not there.
    let is_lacking = |text: &String| {
        text.starts_with("these labels are not")
            || !case.wanted.is_empty() && text.starts_with("the volume has no label")
    };
    let lacks_label = warnings.iter().any(is_lacking);
    match expected {
        Ok(_) if lacks_label => {
            assert!(!succeeded && errors.contains("does not hold"), "{errors}");
            assert!(mesh.triangles.is_empty());
        }
        Err(_) => {
            assert!(!succeeded && errors.len() > 20, "no message: {errors}");
            assert!(mesh.points.is_empty() && mesh.triangles.is_empty());
        }
        Ok(expected) => {
            assert!(succeeded, "{errors}");
            assert!(
                mesh == expected,
                "the filter has another mesh than the library"
            );
            let shown = filter.warnings().to_string_lossy();
            for warning in warnings {
                assert!(shown.contains(&warning), "{warning:?} is not in {shown:?}");
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig {
        failure_persistence: None,
        max_shrink_iters: 200,
        ..ProptestConfig::with_cases(1500)
    })]

    #[test]
    fn the_filter_gives_what_the_library_gives(case in cases()) {
        check(&case);
    }
}
