//! Every large buffer is refused once: the run ends with an error that says so, not with an abort.
//!
//! The allocator of this program refuses the n-th large buffer, with n = 1, 2, 3 and so on until a run
//! gets all that it asks for. An abort ends the program; the last line that it printed tells how far
//! it got.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

use midsurface::{
    extract, extract_piece, mid_polylines_piece, ridge_field_piece, statistics,
    zip_polylines_piece, Error, Exchange, Grid, Method, Options, Quiet, TriangleMesh, Vec3, Volume,
};
use ndarray::Array3;

/// Buffers of fewer bytes are granted. Workers have buffers of their own, which are as large as a block
/// of the surface or a slice of the volume at most, whatever the size of the data.
const LARGE: usize = 8 << 10;
const LARGE_OF_WORKER: usize = 32 << 10;

/// Large buffers asked for, and which of them is refused.
static ASKED: AtomicUsize = AtomicUsize::new(0);
static REFUSED: AtomicUsize = AtomicUsize::new(usize::MAX);

thread_local! {
    /// Whether this is the thread that calls the library.
    static IS_CALLER: Cell<bool> = const { Cell::new(false) };
}

/// Voxels along each axis of the volume.
const SIZE: usize = 48;

struct Refusing;

impl Refusing {
    fn refuses(size: usize) -> bool {
        let is_caller = IS_CALLER.try_with(Cell::get).unwrap_or(false);
        let least = if is_caller { LARGE } else { LARGE_OF_WORKER };
        size >= least && ASKED.fetch_add(1, Relaxed) + 1 == REFUSED.load(Relaxed)
    }
}

// SAFETY: all that is not refused is the system's.
unsafe impl GlobalAlloc for Refusing {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        if Self::refuses(layout.size()) {
            return std::ptr::null_mut();
        }
        // SAFETY: the caller's layout.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, place: *mut u8, layout: Layout) {
        // SAFETY: what the system gave.
        unsafe { System.dealloc(place, layout) };
    }
}

#[global_allocator]
static ALLOCATOR: Refusing = Refusing;

/// A sphere with a hole, and a sheet that touches its inside.
fn labels(size: usize) -> Vec<u8> {
    let middle = size as f64 / 2.0;
    let voxel = |i: usize| {
        let [x, y, z] = [i % size, i / size % size, i / size / size].map(|v| v as f64 - middle);
        let radius = (x * x + y * y + z * z).sqrt();
        let in_shell = (radius - 0.8 * middle).abs() < 2.6 && x.hypot(y - 3.0) > 9.0;
        let in_sheet = radius < 0.8 * middle && (z - 0.3 * x).abs() < 1.8;
        u8::from(in_shell || in_sheet)
    };
    (0..size.pow(3)).map(voxel).collect()
}

/// The only process of a run.
struct Alone;

impl Exchange for Alone {
    fn processes(&self) -> usize {
        1
    }
    fn process(&self) -> usize {
        0
    }
    fn send(&mut self, _to: usize, _numbers: &[i64]) -> bool {
        false
    }
    fn receive(&mut self, _from: usize, _numbers: &mut [i64]) -> bool {
        false
    }
}

/// Runs `run` until it gets what it asks for; at least so many large buffers have to be refused.
fn refuse_each<T>(name: &str, least: usize, mut run: impl FnMut() -> Result<T, Error>) {
    for n in 1.. {
        println!("{name}: large buffer {n} is refused");
        ASKED.store(0, Relaxed);
        REFUSED.store(n, Relaxed);
        let result = run();
        REFUSED.store(usize::MAX, Relaxed);
        match result {
            Ok(_) => {
                assert!(n > least, "{name} has {} large buffers only", n - 1);
                return;
            }
            Err(error) => assert!(matches!(error, Error::OutOfMemory(_)), "{error}"),
        }
    }
}

#[test]
fn a_refused_buffer_is_an_error() {
    IS_CALLER.set(true);
    let labels = labels(SIZE);
    let grid = Grid::new([SIZE; 3]);
    let volume = Volume::new(&labels, grid.clone()).expect("a sound volume");
    let ridge_surface = Options {
        threads: 1,
        ..Options::default()
    };
    let zipper = Options {
        method: Method::PolylineZipper,
        ..ridge_surface.clone()
    };
    let quiet = &mut Quiet::default();
    let mut fields = [(); 2].map(|()| Array3::<f32>::zeros([SIZE; 3]));
    refuse_each("ridge surface", 200, || {
        extract(&volume, &ridge_surface, quiet)
    });
    refuse_each("polyline zipper", 80, || extract(&volume, &zipper, quiet));
    refuse_each("polyline zipper on a piece", 80, || {
        extract_piece(Some(&volume), &grid, &zipper, &mut Alone, quiet)
    });
    refuse_each("polylines on a piece, zipped", 60, || {
        let alone = &mut Alone;
        let lines = mid_polylines_piece(Some(&volume), &grid, &zipper, alone, quiet)?;
        zip_polylines_piece(&lines, &zipper, alone, quiet)
    });
    refuse_each("fields on a piece", 20, || {
        let [distance, ridge] = fields.each_mut().map(Array3::view_mut);
        let (piece, alone) = (Some(&volume), &mut Alone);
        ridge_field_piece(piece, &grid, &zipper, alone, quiet, distance, ridge)
    });
    let mesh = extract(&volume, &ridge_surface, quiet).expect("a mesh");
    refuse_each("quality", 2, || mesh.quality());
    let points: Vec<Vec3> = mesh.points.iter().map(|p| p.map(f64::from)).collect();
    let triangles: Vec<[i64; 3]> = mesh.triangles.iter().map(|t| t.map(i64::from)).collect();
    let table = TriangleMesh {
        points: &points,
        triangles: &triangles,
        thickness: Some(&mesh.thickness),
        labels: Some(&mesh.labels),
        ..TriangleMesh::default()
    };
    refuse_each("statistics", 4, || statistics(&table));
}
