//! The input: labels of any scalar type, borrowed, with their frame.

use ndarray::ArrayView3;

use crate::error::{Error, Result};
use crate::grid::Grid;

/// Labels as they lie in memory: shape (z, y, x), x fastest.
#[derive(Debug, Clone, Copy)]
#[allow(missing_docs)]
pub enum Scalars<'a> {
    I8(ArrayView3<'a, i8>),
    U8(ArrayView3<'a, u8>),
    I16(ArrayView3<'a, i16>),
    U16(ArrayView3<'a, u16>),
    I32(ArrayView3<'a, i32>),
    U32(ArrayView3<'a, u32>),
    I64(ArrayView3<'a, i64>),
    U64(ArrayView3<'a, u64>),
    F32(ArrayView3<'a, f32>),
    F64(ArrayView3<'a, f64>),
}

/// A scalar type that can hold labels. 0 is background.
pub trait Label: Copy + PartialEq + Default + Send + Sync + std::fmt::Display {
    /// The label as an integer, or `None` where the value is not a whole number.
    fn label(self) -> Option<i64>;
    /// The values as the variant of [`Scalars`] that holds them.
    fn scalars(view: ArrayView3<'_, Self>) -> Scalars<'_>;
}

macro_rules! label {
    ($type:ty, $variant:ident, $convert:expr) => {
        impl Label for $type {
            fn label(self) -> Option<i64> {
                let convert: fn($type) -> Option<i64> = $convert;
                convert(self)
            }
            fn scalars(view: ArrayView3<'_, Self>) -> Scalars<'_> {
                Scalars::$variant(view)
            }
        }
    };
}

/// Beyond 2⁵³ a double no longer tells neighbouring whole numbers apart.
fn whole(value: f64) -> Option<i64> {
    (value.fract() == 0.0 && value.abs() <= 9_007_199_254_740_992.0).then_some(value as i64)
}

label!(i8, I8, |v| Some(v.into()));
label!(u8, U8, |v| Some(v.into()));
label!(i16, I16, |v| Some(v.into()));
label!(u16, U16, |v| Some(v.into()));
label!(i32, I32, |v| Some(v.into()));
label!(u32, U32, |v| Some(v.into()));
label!(i64, I64, Some);
label!(u64, U64, |v| v.try_into().ok());
label!(f32, F32, |v| whole(v.into()));
label!(f64, F64, whole);

/// A label volume: borrowed scalars and where they lie.
#[derive(Debug, Clone)]
pub struct Volume<'a> {
    pub(crate) scalars: Scalars<'a>,
    pub(crate) grid: Grid,
}

impl<'a> Volume<'a> {
    /// Borrows `scalars`, x fastest, then y, then z. Nothing is copied.
    ///
    /// # Errors
    /// Where the buffer's length is not the product of the dimensions, or the frame is unusable.
    pub fn new<T: Label>(scalars: &'a [T], grid: Grid) -> Result<Self> {
        grid.check()?;
        let [x, y, z] = grid.dimensions;
        let mismatch = Error::BufferLength {
            dimensions: grid.dimensions,
            length: scalars.len(),
        };
        if grid.voxel_count()? != scalars.len() {
            return Err(mismatch);
        }
        let view = ArrayView3::from_shape((z, y, x), scalars).map_err(|_| mismatch)?;
        Ok(Self {
            scalars: T::scalars(view),
            grid,
        })
    }

    /// Where the voxels lie.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }
}
