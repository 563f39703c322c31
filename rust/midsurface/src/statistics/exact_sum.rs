//! Sums of floats that are the same to the bit in whichever order their terms come.
//!
//! A sum is kept as floats that do not overlap and together are exactly the sum of all terms (Shewchuk,
//! "Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates", 1997); rounded is
//! only its value. So parts of a sum may be made anywhere. A sum beyond the largest float is infinite or
//! no number, as that of floats is.

use crate::error::{collected, extend, Error, Result};
use crate::processes::exchange::taken;

/// The exact sum of what was added.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct ExactSum {
    /// Ordered by size, the smallest first; at most about forty.
    parts: Vec<f64>,
}

impl ExactSum {
    /// The sum of some terms.
    pub fn of(terms: impl IntoIterator<Item = f64>) -> Self {
        let mut sum = Self::default();
        terms.into_iter().for_each(|term| sum.add(term));
        sum
    }

    /// Adds a term.
    pub fn add(&mut self, term: f64) {
        let mut high = term;
        let mut kept = 0;
        for i in 0..self.parts.len() {
            let (sum, rest) = with_rest(high, self.parts[i]);
            if rest != 0.0 {
                self.parts[kept] = rest;
                kept += 1;
            }
            high = sum;
        }
        self.parts.truncate(if high.is_finite() { kept } else { 0 });
        self.parts.push(high);
    }

    /// Adds all terms of another sum.
    pub fn add_sum(&mut self, other: &Self) {
        other.parts.iter().for_each(|&part| self.add(part));
    }

    /// The float nearest to the sum, of two as near the even one.
    pub fn value(&self) -> f64 {
        let mut below = self.parts.iter().rev().copied();
        let mut high = below.next().unwrap_or(0.0);
        while let Some(part) = below.next() {
            let (sum, rest) = with_rest(high, part);
            high = sum;
            if rest == 0.0 {
                continue;
            }
            // Half-way between two floats what is below decides.
            let is_more = below
                .next()
                .is_some_and(|next| (next < 0.0) == (rest < 0.0));
            let farther = high + 2.0 * rest;
            if is_more && farther - high == 2.0 * rest {
                return farther;
            }
            break;
        }
        high
    }

    /// Appends the sum to a message for another process.
    pub fn pack(&self, message: &mut Vec<i64>) -> Result<()> {
        let parts = self.parts.iter().map(|part| part.to_bits() as i64);
        extend(message, [self.parts.len() as i64].into_iter().chain(parts))
    }

    /// Takes a sum from the beginning of a message.
    pub fn unpack(message: &mut &[i64]) -> Result<Self> {
        let [count] = taken(message)?;
        let (parts, rest) = message
            .split_at_checked(count as usize)
            .ok_or(Error::Pieces)?;
        *message = rest;
        let parts = collected(parts.iter().map(|&bits| f64::from_bits(bits as u64)))?;
        Ok(Self { parts })
    }
}

/// A sum as the nearest float, and exactly what is left of it.
fn with_rest(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let of_b = sum - a;
    (sum, (a - (sum - of_b)) + (b - of_b))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn nothing_is_lost() {
        let sum = |terms: &[f64]| ExactSum::of(terms.iter().copied()).value();
        assert_eq!(sum(&[]), 0.0);
        assert_eq!(sum(&[0.1; 10]), 1.0);
        assert_eq!(sum(&[1e300, 1.0, -1e300, 1e-300]), 1.0);
        assert_eq!(sum(&[1e300, 1e-300, -1e300]), 1e-300);
        // Half-way, and a little more.
        let half = 0.5 * f64::EPSILON;
        assert_eq!(sum(&[1.0, half]), 1.0);
        assert_eq!(sum(&[1.0, half, 1e-200]), 1.0 + f64::EPSILON);
        assert_eq!(sum(&[1.0, -0.5 * half, -1e-200]), 1.0 - half);
        assert_eq!(
            sum(&[1.0 + f64::EPSILON, half, -1e-200]),
            1.0 + f64::EPSILON
        );
    }

    #[test]
    fn what_no_float_holds_is_told() {
        let mut sum = ExactSum::of([f64::MAX, f64::MAX, 1.0, 1e-300]);
        assert_eq!(sum.value(), f64::INFINITY);
        assert!(sum.parts.len() == 1);
        sum.add(f64::NEG_INFINITY);
        sum.add(1.0);
        assert!(sum.value().is_nan());
    }

    proptest! {
        #[test]
        fn order_and_parts_make_no_difference(
            terms in prop::collection::vec((-1.0..1.0f64, -300..300i32), 0..60),
            at in 0..60usize,
        ) {
            let terms: Vec<f64> = terms.iter().map(|(v, e)| v * 2f64.powi(*e)).collect();
            let sum = ExactSum::of(terms.iter().copied());
            let mut backwards = ExactSum::of(terms.iter().rev().copied());
            prop_assert_eq!(sum.value().to_bits(), backwards.value().to_bits());
            let (first, second) = terms.split_at(at.min(terms.len()));
            let mut message = Vec::new();
            ExactSum::of(first.iter().copied()).pack(&mut message).unwrap();
            let mut both = ExactSum::of(second.iter().copied());
            both.add_sum(&ExactSum::unpack(&mut &message[..]).unwrap());
            prop_assert_eq!(sum.value().to_bits(), both.value().to_bits());
            terms.iter().for_each(|&term| backwards.add(-term));
            prop_assert_eq!(backwards.value(), 0.0);
        }
    }
}
