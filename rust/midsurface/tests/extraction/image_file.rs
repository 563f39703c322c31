//! Reads the one kind of .vti file that the real data comes in: one array of bytes, inline,
//! base64, compressed with zlib.

use std::io::Read;
use std::path::Path;

use base64::engine::general_purpose::STANDARD;
use base64::Engine;
use midsurface::Grid;

/// The numbers in an attribute's value.
fn numbers(text: &str, attribute: &str) -> Vec<f64> {
    let value = text
        .split(&format!("{attribute}=\""))
        .nth(1)
        .and_then(|t| t.split('"').next());
    let value = value.unwrap_or_else(|| panic!("the file has no {attribute}"));
    value
        .split_whitespace()
        .map(|n| n.parse().expect("a number"))
        .collect()
}

fn word(bytes: &[u8], index: usize) -> usize {
    u64::from_le_bytes(bytes[8 * index..8 * index + 8].try_into().expect("8 bytes")) as usize
}

/// Bytes of the array, x fastest, and where the voxels lie.
pub fn read(path: &Path) -> (Vec<u8>, Grid) {
    let text = std::fs::read_to_string(path).expect("a readable file");
    let extent = numbers(&text, "WholeExtent");
    let mut grid = Grid::new([0, 2, 4].map(|a| (extent[a + 1] - extent[a]) as usize + 1));
    grid.extent_start = [0, 2, 4].map(|a| extent[a] as i64);
    grid.origin.copy_from_slice(&numbers(&text, "Origin"));
    grid.spacing.copy_from_slice(&numbers(&text, "Spacing"));

    let array = text.split("<DataArray").nth(1).expect("an array");
    let data = array.split_once('>').expect("an array").1;
    let data = data.split('<').next().unwrap_or("").trim();
    // A header: number of blocks, size of a block, size of the last one, compressed sizes; then
    // the blocks. Both are encoded by themselves, so that padding lies between them.
    let blocks = word(&STANDARD.decode(&data[..12]).expect("base64"), 0);
    let header_length = (8 * (3 + blocks)).div_ceil(3) * 4;
    let header = STANDARD.decode(&data[..header_length]).expect("base64");
    let body = STANDARD.decode(&data[header_length..]).expect("base64");
    let mut labels = Vec::with_capacity(grid.dimensions.iter().product());
    let mut start = 0;
    for block in 0..blocks {
        let end = start + word(&header, 3 + block);
        let mut decoder = flate2::read::ZlibDecoder::new(&body[start..end]);
        decoder.read_to_end(&mut labels).expect("zlib");
        start = end;
    }
    (labels, grid)
}
