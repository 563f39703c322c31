//! Parts in lots: those components that are worked on as a whole, in batches (`batches.rs`), and each one
//! that is too large for that, in tiles (`tiles`).

use crate::error::{push, Result};
use crate::reading::components::Part;

/// What is worked on in tiles, and how large these are.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sizes {
    /// A component of more labelled voxels is.
    pub most_voxels: usize,
    /// Voxels along a tile's edge, a multiple of a brick's.
    pub side: usize,
}

impl Sizes {
    pub const USUAL: Self = Self {
        most_voxels: 4_000_000,
        side: 512,
    };

    /// Whether parts make up a component that is worked on in tiles.
    pub fn is_tiled(&self, lot: &[Part]) -> bool {
        let is_one = lot.first().map(|part| part.component) == lot.last().map(|p| p.component);
        is_one && lot.iter().map(Part::voxels).sum::<usize>() > self.most_voxels
    }

    /// Parts in lots of whole components, in their order: each component that is worked on in tiles alone.
    pub fn lots<'a>(&self, parts: &'a [Part]) -> Result<Vec<&'a [Part]>> {
        let mut lots = Vec::new();
        let mut left = parts;
        let mut count = 0;
        for component in parts.chunk_by(|a, b| a.component == b.component) {
            if self.is_tiled(component) {
                for size in [count, component.len()] {
                    let (lot, rest) = left.split_at(size);
                    push(&mut lots, lot)?;
                    left = rest;
                }
                count = 0;
            } else {
                count += component.len();
            }
        }
        push(&mut lots, left)?;
        lots.retain(|lot| !lot.is_empty());
        Ok(lots)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reading::runs::Run;

    #[test]
    fn a_large_component_is_a_lot_of_its_own() {
        let part = |(component, voxels): &(u32, u32)| Part {
            label: 1,
            component: *component,
            runs: vec![Run {
                label: 1,
                z: 0,
                y: 0,
                start: 0,
                end: *voxels,
            }],
        };
        let of_parts = [(0, 60), (0, 50), (1, 100), (2, 101), (3, 1), (4, 1)];
        let parts: Vec<Part> = of_parts.iter().map(part).collect();
        let sizes = Sizes {
            most_voxels: 100,
            ..Sizes::USUAL
        };
        let lots = sizes.lots(&parts).unwrap();
        let expected = [&parts[..2], &parts[2..3], &parts[3..4], &parts[4..]];
        assert_eq!(lots, expected);
        let is_tiled: Vec<bool> = lots.iter().map(|lot| sizes.is_tiled(lot)).collect();
        assert_eq!(is_tiled, [true, false, true, false]);
    }
}
