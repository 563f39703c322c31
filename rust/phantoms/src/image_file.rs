//! Label volumes as files that ParaView reads.

use std::io::{self, Write};

use base64::engine::general_purpose::STANDARD;
use base64::write::EncoderWriter;

use crate::phantom::Frame;

/// Writes a VTK image file: one unsigned 8-bit point array `Labels`, inline and uncompressed,
/// since some XML libraries break appended data.
pub fn write_vti(out: &mut impl Write, frame: &Frame, labels: &[u8]) -> io::Result<()> {
    let numbers = |values: &[f64]| {
        let texts: Vec<String> = values.iter().map(f64::to_string).collect();
        texts.join(" ")
    };
    let extent: Vec<f64> = (0..3)
        .flat_map(|a| {
            let first = frame.extent_start[a] as f64;
            [first, first + frame.dimensions[a] as f64 - 1.0]
        })
        .collect();
    let (extent, origin, spacing, direction) = (
        numbers(&extent),
        numbers(&frame.origin),
        numbers(&frame.spacing),
        numbers(frame.direction.as_flattened()),
    );
    write!(
        out,
        r#"<?xml version="1.0"?>
<VTKFile type="ImageData" version="1.0" byte_order="LittleEndian" header_type="UInt64">
<ImageData WholeExtent="{extent}" Origin="{origin}" Spacing="{spacing}" Direction="{direction}">
<Piece Extent="{extent}">
<PointData Scalars="Labels">
<DataArray type="UInt8" Name="Labels" format="binary">
"#
    )?;
    let mut encoder = EncoderWriter::new(&mut *out, &STANDARD);
    encoder.write_all(&(labels.len() as u64).to_le_bytes())?;
    encoder.write_all(labels)?;
    encoder.finish()?;
    drop(encoder);
    out.write_all(b"\n</DataArray>\n</PointData>\n</Piece>\n</ImageData>\n</VTKFile>\n")
}

/// Writes an MRC file of signed bytes (mode 0), the format of most tomography programs. It holds
/// neither a direction nor labels above 127.
pub fn write_mrc(out: &mut impl Write, frame: &Frame, labels: &[u8]) -> io::Result<()> {
    const HEADER: usize = 1024;
    let mut header = [0u8; HEADER];
    let mut put = |word: usize, bytes: [u8; 4]| {
        header[4 * (word - 1)..4 * word].copy_from_slice(&bytes);
    };
    for axis in 0..3 {
        let n = frame.dimensions[axis] as i32;
        let cell = (frame.spacing[axis] * f64::from(n)) as f32;
        put(1 + axis, n.to_le_bytes());
        put(5 + axis, (frame.extent_start[axis] as i32).to_le_bytes());
        put(8 + axis, n.to_le_bytes());
        put(11 + axis, cell.to_le_bytes());
        put(14 + axis, 90f32.to_le_bytes());
        put(17 + axis, (axis as i32 + 1).to_le_bytes());
        put(50 + axis, (frame.origin[axis] as f32).to_le_bytes());
    }
    let (least, most) = (labels.iter().min(), labels.iter().max());
    let sum: u64 = labels.iter().map(|&l| u64::from(l)).sum();
    put(20, f32::from(*least.unwrap_or(&0)).to_le_bytes());
    put(21, f32::from(*most.unwrap_or(&0)).to_le_bytes());
    put(22, (sum as f32 / labels.len().max(1) as f32).to_le_bytes());
    put(28, 20140i32.to_le_bytes());
    put(53, *b"MAP ");
    put(54, [0x44, 0x44, 0, 0]);
    out.write_all(&header)?;
    out.write_all(labels)
}
