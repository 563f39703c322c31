//! The input: labels, or a map with a threshold, of any scalar type, borrowed, with their frame.

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
pub trait Label: Copy + PartialOrd + Default + Send + Sync + std::fmt::Display {
    /// The label as an integer, or `None` where the value is not a whole number or too large.
    fn label(self) -> Option<i64>;
    /// Whether it is a whole number.
    fn is_whole(self) -> bool;
    /// Whether it is no number at all.
    fn is_nan(self) -> bool;
    /// The least value that is at or above a finite threshold; `None` where there is none.
    fn at_or_above(threshold: f64) -> Option<Self>;
    /// The values as the variant of [`Scalars`] that holds them.
    fn scalars(view: ArrayView3<'_, Self>) -> Scalars<'_>;
}

macro_rules! integer_label {
    ($($type:ident $variant:ident),*) => { $(
        impl Label for $type {
            fn label(self) -> Option<i64> {
                i64::try_from(self).ok()
            }
            fn is_whole(self) -> bool {
                true
            }
            fn is_nan(self) -> bool {
                false
            }
            fn at_or_above(threshold: f64) -> Option<Self> {
                // The conversion ends at the type's own limits.
                (threshold.ceil() < $type::MAX as f64 + 1.0).then_some(threshold.ceil() as $type)
            }
            fn scalars(view: ArrayView3<'_, Self>) -> Scalars<'_> {
                Scalars::$variant(view)
            }
        }
    )* };
}

integer_label!(i8 I8, u8 U8, i16 I16, u16 U16, i32 I32, u32 U32, i64 I64, u64 U64);

/// Beyond 2⁵³ a double no longer tells neighbouring whole numbers apart.
const LARGEST_FLOAT_LABEL: f64 = 9_007_199_254_740_992.0;

macro_rules! float_label {
    ($type:ident $variant:ident, $at_or_above:expr) => {
        impl Label for $type {
            fn label(self) -> Option<i64> {
                let is_label = self.is_whole() && f64::from(self).abs() <= LARGEST_FLOAT_LABEL;
                is_label.then_some(self as i64)
            }
            fn is_whole(self) -> bool {
                self.fract() == 0.0
            }
            fn is_nan(self) -> bool {
                self.is_nan()
            }
            fn at_or_above(threshold: f64) -> Option<Self> {
                Some($at_or_above(threshold))
            }
            fn scalars(view: ArrayView3<'_, Self>) -> Scalars<'_> {
                Scalars::$variant(view)
            }
        }
    };
}

float_label!(f32 F32, least_f32);
float_label!(f64 F64, std::convert::identity);

/// The least single at or above a finite double.
fn least_f32(threshold: f64) -> f32 {
    let nearest = threshold as f32;
    if f64::from(nearest) >= threshold {
        return nearest;
    }
    // The next one up: neighbours have neighbouring bits, which count away from 0.
    match nearest {
        0.0 => f32::from_bits(1),
        n if n > 0.0 => f32::from_bits(n.to_bits() + 1),
        n => f32::from_bits(n.to_bits() - 1),
    }
}

/// A label volume: borrowed scalars and where they lie.
#[derive(Debug, Clone)]
pub struct Volume<'a> {
    pub(crate) scalars: Scalars<'a>,
    pub(crate) grid: Grid,
    /// Where there is one, everything at or above it is label 1, whatever its value.
    pub(crate) threshold: Option<f64>,
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
            threshold: None,
        })
    }

    /// Takes the scalars for the values of a map, such as probabilities, instead of labels:
    /// everything at or above `threshold` is label 1, all else, NaN too, is background.
    ///
    /// # Errors
    /// Where the threshold is not finite.
    pub fn with_threshold(self, threshold: f64) -> Result<Self> {
        if !threshold.is_finite() {
            return Err(Error::Threshold(threshold));
        }
        Ok(Self {
            threshold: Some(threshold),
            ..self
        })
    }

    /// Where the voxels lie.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_threshold_becomes_the_least_value_that_reaches_it() {
        assert_eq!(u8::at_or_above(0.5), Some(1));
        assert_eq!(u8::at_or_above(-3.0), Some(0));
        assert_eq!(u8::at_or_above(255.0), Some(255));
        assert_eq!(u8::at_or_above(255.5), None);
        assert_eq!(i8::at_or_above(-200.0), Some(-128));
        assert_eq!(i64::at_or_above(9_223_372_036_854_775_808.0), None);
        assert_eq!(i64::at_or_above(-1e300), Some(i64::MIN));
        assert_eq!(f64::at_or_above(0.3), Some(0.3));
        // 0.1 lies below the nearest single, 0.3 above it.
        assert_eq!(f32::at_or_above(0.1), Some(0.1));
        for threshold in [0.3, -0.1, 1e-60, 0.7, -1e-60] {
            let least = f32::at_or_above(threshold).expect("a float");
            assert!(f64::from(least) >= threshold, "{threshold}");
            let below = match least {
                n if n > 0.0 => f32::from_bits(n.to_bits() - 1),
                0.0 => -f32::from_bits(1),
                n => f32::from_bits(n.to_bits() + 1),
            };
            assert!(f64::from(below) < threshold, "{threshold}");
        }
    }
}
