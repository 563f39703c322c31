//! Meshes as files to look at.

use std::io::{self, Write};

/// Writes a binary PLY file of points and triangles.
pub fn write_ply(
    out: &mut impl Write,
    points: &[[f32; 3]],
    triangles: &[[u32; 3]],
) -> io::Result<()> {
    write!(
        out,
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\n\
         property float y\nproperty float z\nelement face {}\n\
         property list uchar int vertex_indices\nend_header\n",
        points.len(),
        triangles.len()
    )?;
    for v in points.as_flattened() {
        out.write_all(&v.to_le_bytes())?;
    }
    for triangle in triangles {
        out.write_all(&[3])?;
        for v in triangle {
            out.write_all(&v.to_le_bytes())?;
        }
    }
    Ok(())
}
