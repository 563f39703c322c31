//! The whole extraction from outside, on label volumes whose mid-surface is known, on random ones
//! and on real ones. One program, so that it is linked once.

mod accuracy;
mod bad_input;
mod beyond_32_bits;
mod chain;
mod channels;
mod determinism;
mod edge_length;
mod fields;
mod frames;
mod image_file;
mod labels;
mod measure;
mod networks;
mod observer;
mod pieces;
mod polylines;
mod random_polylines;
mod random_volumes;
mod real_data;
mod statistics;
mod thickness;
mod topology;

use midsurface::Exchange;
