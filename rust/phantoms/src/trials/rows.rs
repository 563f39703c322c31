//! The lines of the table.

use super::bent::{bent_tube, cristae, fold, invagination};
use super::frames::frame_trials;
use super::Trial;
use crate::dice::Dice;
use crate::phantom::{Frame, Junction, Neighbours, Phantom, Slab, Thickness, Topology};
use crate::shape::{Hole, Rim, Shape};
use crate::vector::{add, cross, dot, scale, unit, Vec3};

/// The volume's side, voxels.
pub(super) const SIDE: usize = 96;

/// All lines, in the order in which they are printed.
pub fn trials() -> Vec<Trial> {
    let mut trials = accuracy_trials();
    trials.extend(closeness_trials());
    trials.extend(shape_trials());
    trials.extend(frame_trials());
    trials
}

const FREE: [f64; 2] = [f64::INFINITY; 2];

fn accuracy_trials() -> Vec<Trial> {
    let thin = |trial: Trial| trial.rms([0.08, 0.10], [0.04, 0.04]);
    let one_voxel = |trial: Trial| trial.rms(FREE, FREE).noisy_topology_is_free();
    vec![
        Trial::new("sphere", |d| sphere(d, [24.0, 40.0], [3.0, 12.0])),
        thin(Trial::new("sphere 2 thick", |d| {
            sphere(d, [24.0, 40.0], [2.0; 2])
        })),
        Trial::new("sphere R=12", |d| sphere(d, [12.0; 2], [2.0, 6.0])).rms(FREE, [0.05, 0.08]),
        Trial::new("sphere 12 to 14 thick", |d| {
            sphere(d, [24.0, 38.0], [12.0, 14.0])
        })
        .rms(FREE, FREE)
        .but(|grades| (grades.must.bias, grades.aim.bias) = (0.05, 0.02)),
        Trial::new("torus", |d| torus(d, [3.0, 8.0])),
        thin(Trial::new("torus 2 thick", |d| torus(d, [2.0; 2]))),
        Trial::new("tube", |d| tube(d, [3.0, 12.0])),
        Trial::new("tube along an axis", tube_along_axis),
        thin(Trial::new("tube 2 thick", |d| tube(d, [2.0; 2]))),
        Trial::new("disk", |d| disk(d, [3.0, 12.0], false)),
        Trial::new("disk with a hole", |d| disk(d, [3.0, 12.0], true)),
        thin(Trial::new("disk with a hole, 2 thick", |d| {
            disk(d, [2.0; 2], true)
        })),
        Trial::new("disk in slices", disk_in_slices),
        Trial::new("cap", |d| cap(d, [3.0, 12.0])),
        thin(Trial::new("cap 2 thick", |d| cap(d, [2.0; 2]))),
        Trial::new("disk 3 to 12 thick", wedge).rms([0.10; 2], [0.04; 2]),
        Trial::new("plane 85 degrees", nearly_axis_parallel).rms([0.12; 2], [0.06; 2]),
        Trial::new("gyroid", gyroid).rms(FREE, FREE).but(|grades| {
            (grades.must.rms_inside, grades.aim.rms_inside) = (0.08, 0.04);
        }),
        one_voxel(Trial::new("sphere 1 thick", |d| {
            sphere_of(d, [24.0, 40.0], one_layer(Neighbours::Six))
        })),
        one_voxel(Trial::new("sphere 1 thick, corners", |d| {
            sphere_of(d, [24.0, 40.0], one_layer(Neighbours::TwentySix))
        })),
        one_voxel(Trial::new("disk with a hole, 1 thick", |d| {
            disk_of(d, one_layer(Neighbours::Six), true)
        })),
        one_voxel(Trial::new("disk with a hole, 1 thick, corners", |d| {
            disk_of(d, one_layer(Neighbours::TwentySix), true)
        })),
    ]
}

fn closeness_trials() -> Vec<Trial> {
    vec![
        Trial::new("nested spheres 4 apart", |d| nested(d, 4.0)),
        Trial::new("nested spheres 3 apart", |d| nested(d, 3.0)),
        Trial::new("nested spheres 2 apart", |d| nested(d, 2.0)).noisy_topology_is_an_aim(),
        Trial::new("nested spheres 1 apart", |d| nested(d, 1.0)).noisy_topology_is_free(),
        Trial::new("two sheets 3 apart", |d| two_sheets(d, 3.0)),
        Trial::new("two sheets 2 apart", |d| two_sheets(d, 2.0)).noisy_topology_is_an_aim(),
        Trial::new("two sheets 1 apart", |d| two_sheets(d, 1.0)).noisy_topology_is_free(),
        Trial::new("thick slab beside thin sheet", thick_beside_thin),
        Trial::new("labels touching, sheets", touching_sheets),
        Trial::new("labels touching, shells", touching_shells),
    ]
}

fn shape_trials() -> Vec<Trial> {
    let junction = |trial: Trial| {
        trial.rms(FREE, FREE).but(|grades| {
            (grades.must.max_error, grades.aim.max_error) = (1.0, 0.6);
            (grades.must.normal_error, grades.aim.normal_error) = (f64::INFINITY, 3.0);
        })
    };
    vec![
        Trial::new("invagination", invagination),
        Trial::new("fold", fold),
        Trial::new("cristae", cristae),
        Trial::new("bent tube", bent_tube),
        Trial::new("sheet with many holes", riddled),
        junction(Trial::new("junction T", |d| {
            junction_of(d, &[0.0, 90.0, 180.0])
        })),
        junction(Trial::new("junction Y", |d| {
            junction_of(d, &[0.0, 120.0, 240.0])
        })),
        junction(Trial::new("junction Y, narrow", |d| {
            junction_of(d, &[0.0, 60.0, 210.0])
        })),
        junction(Trial::new("junction X", |d| {
            junction_of(d, &[0.0, 90.0, 180.0, 270.0])
        })),
    ]
}

pub(super) fn cube() -> Frame {
    Frame::new([SIDE; 3])
}

pub(super) fn constant(dice: &mut Dice, thickness: [f64; 2]) -> Thickness {
    Thickness::Constant(dice.between(thickness[0], thickness[1]))
}

fn one_layer(neighbours: Neighbours) -> Thickness {
    Thickness::OneVoxel(neighbours)
}

/// A phantom of one slab of label 1; topology as components, Euler number, boundary loops.
pub(super) fn single(
    frame: Frame,
    shape: Shape,
    thickness: Thickness,
    topology: [i64; 3],
) -> Phantom {
    let slab = Slab {
        shape,
        thickness,
        label: 1,
    };
    Phantom::new("", frame, vec![slab], exactly(topology))
}

pub(super) fn exactly([components, euler, loops]: [i64; 3]) -> Option<Topology> {
    Some(Topology {
        components: components as usize,
        euler,
        boundary_loops: loops as usize,
    })
}

fn sphere(dice: &mut Dice, radius: [f64; 2], thickness: [f64; 2]) -> Phantom {
    let thickness = constant(dice, thickness);
    sphere_of(dice, radius, thickness)
}

fn sphere_of(dice: &mut Dice, radius: [f64; 2], thickness: Thickness) -> Phantom {
    let frame = cube();
    let radius = dice.between(radius[0], radius[1]);
    let centre = dice.place(&frame, 0.7);
    single(
        frame,
        Shape::Sphere { centre, radius },
        thickness,
        [1, 2, 0],
    )
}

fn torus(dice: &mut Dice, thickness: [f64; 2]) -> Phantom {
    let frame = cube();
    let shape = Shape::Torus {
        centre: dice.place(&frame, 0.7),
        axis: dice.direction(),
        ring_radius: dice.between(22.0, 30.0),
        tube_radius: dice.between(10.0, 12.0),
    };
    single(frame, shape, constant(dice, thickness), [1, 0, 0])
}

fn tube(dice: &mut Dice, thickness: [f64; 2]) -> Phantom {
    tube_along(dice, Dice::direction, thickness)
}

/// All slices across the axis are the same, and so are their errors.
fn tube_along_axis(dice: &mut Dice) -> Phantom {
    const AXES: [Vec3; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    tube_along(dice, |dice| dice.one_of(&AXES), [3.0, 12.0])
}

fn tube_along(
    dice: &mut Dice,
    axis: impl FnOnce(&mut Dice) -> Vec3,
    thickness: [f64; 2],
) -> Phantom {
    let frame = cube();
    let shape = Shape::Tube {
        centre: dice.place(&frame, 3.0),
        axis: axis(dice),
        radius: dice.between(15.0, 28.0),
    };
    single(frame, shape, constant(dice, thickness), [1, 0, 2])
}

fn disk(dice: &mut Dice, thickness: [f64; 2], hole: bool) -> Phantom {
    let thickness = constant(dice, thickness);
    disk_of(dice, thickness, hole)
}

fn disk_of(dice: &mut Dice, thickness: Thickness, hole: bool) -> Phantom {
    let normal = dice.direction();
    disk_along(dice, normal, thickness, hole)
}

fn disk_along(dice: &mut Dice, normal: Vec3, thickness: Thickness, hole: bool) -> Phantom {
    let frame = cube();
    let centre = dice.place(&frame, 1.5);
    let radius = dice.between(8.0, 14.0);
    let shape = Shape::Plane {
        centre,
        normal,
        rim: Rim::Circle(dice.between(28.0, 38.0)),
        holes: hole
            .then_some(Hole { centre, radius })
            .into_iter()
            .collect(),
    };
    let topology = if hole { [1, 0, 2] } else { [1, 1, 1] };
    single(frame, shape, thickness, topology)
}

fn disk_in_slices(dice: &mut Dice) -> Phantom {
    let normal = dice.one_of(&[[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]]);
    let thickness = constant(dice, [2.0, 12.0]);
    let hole = dice.one_of(&[false, true]);
    disk_along(dice, normal, thickness, hole)
}

fn cap(dice: &mut Dice, thickness: [f64; 2]) -> Phantom {
    let frame = cube();
    let shape = Shape::Cap {
        centre: dice.place(&frame, 1.5),
        radius: dice.between(24.0, 36.0),
        axis: dice.direction(),
        opening: dice.between(60.0, 130.0),
    };
    single(frame, shape, constant(dice, thickness), [1, 1, 1])
}

fn wedge(dice: &mut Dice) -> Phantom {
    let frame = cube();
    let centre = dice.place(&frame, 1.5);
    let [normal, across] = dice.axes();
    let radius = dice.between(30.0, 38.0);
    let shape = Shape::Plane {
        centre,
        normal,
        rim: Rim::Circle(radius),
        holes: Vec::new(),
    };
    let thickness = Thickness::Linear {
        from: 3.0,
        to: 12.0,
        start: add(centre, scale(-radius, across)),
        along: scale(2.0 * radius, across),
    };
    single(frame, shape, thickness, [1, 1, 1])
}

fn plane(centre: Vec3, normal: Vec3, rim: Rim, holes: Vec<Hole>) -> Shape {
    Shape::Plane {
        centre,
        normal,
        rim,
        holes,
    }
}

fn nearly_axis_parallel(dice: &mut Dice) -> Phantom {
    let frame = cube();
    let (sin, cos) = dice.between(0.0, std::f64::consts::TAU).sin_cos();
    let lean = 5f64.to_radians().sin();
    let first = dice.one_of(&[0, 1, 2]);
    let mut normal = [0.0; 3];
    normal[first] = (1.0 - lean * lean).sqrt();
    normal[(first + 1) % 3] = lean * cos;
    normal[(first + 2) % 3] = lean * sin;
    let shape = plane(dice.place(&frame, 4.0), normal, Rim::None, Vec::new());
    single(frame, shape, constant(dice, [3.0, 10.0]), [1, 1, 1])
}

fn gyroid(dice: &mut Dice) -> Phantom {
    let shape = Shape::Gyroid {
        centre: dice.place(&cube(), 20.0),
        period: dice.between(40.0, 56.0),
    };
    let slab = Slab {
        shape,
        thickness: constant(dice, [3.0, 6.0]),
        label: 1,
    };
    Phantom::new("", cube(), vec![slab], None)
}

fn nested(dice: &mut Dice, gap: f64) -> Phantom {
    let frame = cube();
    let centre = dice.place(&frame, 0.7);
    let thickness = dice.between(3.0, 5.0);
    let outer = dice.between(32.0, 40.0);
    let slabs = (0..3).map(|i| Slab {
        shape: Shape::Sphere {
            centre,
            radius: outer - f64::from(i) * (thickness + gap),
        },
        thickness: Thickness::Constant(thickness),
        label: 1,
    });
    Phantom::new("", frame, slabs.collect(), exactly([3, 6, 0]))
}

/// How far apart the faces must be for so many voxels to fit in everywhere along an axis.
fn voxels_along(normal: Vec3, voxels: f64) -> f64 {
    voxels * normal.iter().map(|v| v.abs()).fold(0.0, f64::max)
}

fn parallel_planes(
    dice: &mut Dice,
    normal: Vec3,
    offsets: &[f64],
    thickness: &[f64],
    labels: &[u8],
) -> Phantom {
    let frame = cube();
    let middle = dice.place(&frame, 3.0);
    let slabs = offsets.iter().zip(thickness).zip(labels);
    let slabs = slabs.map(|((&offset, &thickness), &label)| Slab {
        shape: plane(
            add(middle, scale(offset, normal)),
            normal,
            Rim::None,
            Vec::new(),
        ),
        thickness: Thickness::Constant(thickness),
        label,
    });
    let count = offsets.len() as i64;
    Phantom::new("", frame, slabs.collect(), exactly([count; 3]))
}

fn two_sheets(dice: &mut Dice, voxels: f64) -> Phantom {
    let normal = dice.direction();
    let thickness = [dice.between(2.0, 5.0), dice.between(2.0, 5.0)];
    let apart = voxels_along(normal, voxels) + 0.5 * (thickness[0] + thickness[1]);
    parallel_planes(dice, normal, &[0.0, apart], &thickness, &[1, 1])
}

fn thick_beside_thin(dice: &mut Dice) -> Phantom {
    let normal = dice.direction();
    let thin = dice.between(1.0, 2.0);
    let gap = dice.between(4.0, 8.0);
    let apart = 10.0 + 0.5 * thin + gap;
    parallel_planes(dice, normal, &[-8.0, apart - 8.0], &[20.0, thin], &[1, 1])
}

fn touching_sheets(dice: &mut Dice) -> Phantom {
    let normal = dice.direction();
    let [a, b, c] = [(); 3].map(|()| dice.between(2.0, 6.0));
    let offsets = [0.0, 0.5 * (a + b), 0.5 * a + b + 0.5 * c];
    parallel_planes(dice, normal, &offsets, &[a, b, c], &[1, 2, 7])
}

fn touching_shells(dice: &mut Dice) -> Phantom {
    let mut phantom = nested(dice, 0.0);
    for (slab, label) in phantom.slabs.iter_mut().zip([3, 1, 200]) {
        slab.label = label;
    }
    Phantom::new("", phantom.frame, phantom.slabs, phantom.topology)
}

fn riddled(dice: &mut Dice) -> Phantom {
    let frame = cube();
    let [normal, across] = dice.axes();
    let centre = dice.place(&frame, 1.5);
    let mut holes = Vec::new();
    for i in -2..=2i32 {
        for j in -2..=2i32 {
            let at = |n: i32, dice: &mut Dice| f64::from(n) * 17.0 + dice.between(-1.5, 1.5);
            let flat = [at(i, dice), at(j, dice)];
            let radius = dice.between(3.0, 5.5);
            if flat[0].hypot(flat[1]) < 35.0 {
                let place = add(
                    scale(flat[0], across),
                    scale(flat[1], cross(normal, across)),
                );
                holes.push(Hole {
                    centre: add(centre, place),
                    radius,
                });
            }
        }
    }
    let count = holes.len() as i64;
    let thickness = constant(dice, [2.0, 6.0]);
    let shape = plane(centre, normal, Rim::None, holes);
    single(frame, shape, thickness, [1, 1 - count, 1 + count])
}

/// Half planes that meet in a line, at these angles round it. Opposite ones are one plane.
fn junction_of(dice: &mut Dice, angles: &[f64]) -> Phantom {
    let frame = cube();
    let point = dice.place(&frame, 4.0);
    let [along, first] = dice.axes();
    let second = cross(along, first);
    let sheets: Vec<Vec3> = angles
        .iter()
        .map(|angle| {
            let (sin, cos) = angle.to_radians().sin_cos();
            unit(add(scale(cos, first), scale(sin, second)))
        })
        .collect();
    let thickness = constant(dice, [2.0, 6.0]);
    let mut slabs = Vec::new();
    for (i, &sheet) in sheets.iter().enumerate() {
        let opposite = |other: &Vec3| dot(*other, sheet) < -1.0 + 1e-9;
        let rim = match sheets.iter().position(opposite) {
            Some(other) if other < i => continue,
            Some(_) => Rim::None,
            None => Rim::Line(sheet),
        };
        slabs.push(Slab {
            shape: plane(point, cross(along, sheet), rim, Vec::new()),
            thickness,
            label: 1,
        });
    }
    Phantom::new("", frame, slabs, None).with_junction(Junction {
        point,
        along,
        sheets,
    })
}
