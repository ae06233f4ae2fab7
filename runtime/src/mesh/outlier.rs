//! Coordinates far outside the rest of a part, as damaged files have them.

use nalgebra::Point3;
use std::fmt;

/// Distance ratio above which a coordinate is an outlier: 2^24. In single precision, at such a distance,
/// most of the other coordinates are indistinguishable from each other.
const OUTLIER_DISTANCE_RATIO: f64 = (1u32 << 24) as f64;

/// A vertex far outside the rest of a part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outlier {
    /// The farthest coordinate of the vertex.
    pub coordinate: f64,
    /// The largest distance of three quarters of the vertices from the median of all, along each axis.
    pub rest: f64,
    /// The number of vertices that far outside.
    pub count: usize,
}

impl fmt::Display for Outlier {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Outlier { coordinate, rest, count } = self;
        write!(f, "the coordinate {coordinate:?} is far outside the part")?;
        if *count > 1 {
            write!(f, ", as are {} more vertices", count - 1)?;
        }
        write!(
            f,
            ": most are within {rest:?} of their middle, less than single precision tells apart there"
        )
    }
}

/// A vertex that is an outlier, and the axis along which it is farthest out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct OutlyingVertex {
    pub(super) index: usize,
    pub(super) axis: usize,
    pub(super) outlier: Outlier,
}

/// Finds the first vertex that is more than 2^24 times as far from the median of all vertices as three
/// quarters of them are. Coordinates must be finite.
pub(super) fn find_outlier(vertices: &[Point3<f64>]) -> Option<OutlyingVertex> {
    if vertices.is_empty() {
        return None;
    }
    let count = vertices.len();
    let median = Point3::from(
        [0, 1, 2].map(|axis| nth(vertices.iter().map(|vertex| vertex[axis]), count / 2)),
    );
    let distances: Vec<f64> = vertices.iter().map(|vertex| (vertex - median).amax()).collect();
    // Three quarters, so that many damaged vertices do not hide each other.
    let rest = nth(distances.iter().copied(), 3 * count / 4);
    // A part most of whose vertices coincide has no size to compare with.
    if rest == 0.0 {
        return None;
    }
    let limit = OUTLIER_DISTANCE_RATIO * rest;
    let index = distances.iter().position(|distance| *distance > limit)?;
    let axis = (vertices[index] - median).iamax();
    let count = distances.iter().filter(|distance| **distance > limit).count();
    let outlier = Outlier { coordinate: vertices[index][axis], rest, count };
    Some(OutlyingVertex { index, axis, outlier })
}

/// Returns the number at an index of the sorted list of some numbers.
fn nth(values: impl Iterator<Item = f64>, index: usize) -> f64 {
    let mut values: Vec<f64> = values.collect();
    *values.select_nth_unstable_by(index, f64::total_cmp).1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_outliers() {
        let mut vertices: Vec<_> = (0..40).map(|k| Point3::new(f64::from(k), 1.0, 0.0)).collect();
        assert_eq!(find_outlier(&vertices), None);
        vertices[3].z = 1e8;
        assert_eq!(find_outlier(&vertices), None, "as far as single precision reaches");
        vertices[7].z = -1e13;
        let found = find_outlier(&vertices).expect("it is far");
        let OutlyingVertex { index, axis, outlier } = found;
        assert_eq!((index, axis, outlier.coordinate, outlier.count), (7, 2, -1e13, 1));
        assert!(outlier.rest < 40.0);
        assert_eq!(find_outlier(&vertices[..0]), None);
        let needle = [[0.0; 3], [4e9, 0.0, 0.0], [0.0, 1e-10, 0.0]].map(Point3::from);
        assert_eq!(find_outlier(&needle), None, "of three none is outside the others");
        let fan: Vec<_> = (0..90).map(|k| Point3::new(f64::from(k / 80), 0.0, 0.0)).collect();
        assert_eq!(find_outlier(&fan), None, "where most are in one place nothing is far");
    }

    /// Checks that each reader reports the location of one outlying coordinate in a tube.
    #[test]
    fn readers_name_the_location_of_an_outlier() {
        use crate::mesh::{Mesh, ObjError, PlyError, SourceLocation, StlError, shapes};
        use crate::unit::Unit;
        let unit = Unit::Millimetre;
        let tube = shapes::tube(1.0, 2.0, 9.0, 12, 3, unit).expect("a tube");
        let mut ascii = Vec::new();
        tube.write_stl_ascii(&mut ascii).expect("written");
        let text = String::from_utf8(ascii).expect("text");
        let line = text.lines().nth(4 + 7 * 2).expect("a line");
        assert!(line.contains("vertex"));
        let damaged = text.replacen(line, "vertex 1 -1e13 3", 1);
        let error = Mesh::from_stl(damaged.as_bytes(), "a.stl", unit).expect_err("far off");
        let found = damaged.lines().position(|line| line.contains("e13")).map(|line| line + 1);
        let StlError::Outlier { location: SourceLocation::Line(line), .. } = error else {
            panic!("{error}")
        };
        assert_eq!(Some(line), found);
        assert!(error.to_string().contains("a.stl, triangle "), "{error}");

        let mut binary = Vec::new();
        tube.write_stl(&mut binary).expect("written");
        let byte = 84 + 50 * 7 + 12 + 12 + 8;
        binary[byte..byte + 4].copy_from_slice(&1e13f32.to_le_bytes());
        let message = Mesh::from_stl(&binary, "a.stl", unit).expect_err("far off").to_string();
        let expected = format!("a.stl, triangle 7 (from 0), byte {byte}: the coordinate 9999999");
        assert!(message.starts_with(&expected), "{message}");

        let mut obj = String::from("# a bar\n");
        tube.vertices().iter().for_each(|v| obj += &format!("v {} {} \\\n {}\n", v.x, v.y, v.z));
        tube.triangles()
            .iter()
            .for_each(|t| obj += &format!("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1));
        let line = obj.lines().nth(1 + 2 * 20).expect("a line").to_owned();
        let damaged = obj.replacen(&line, "v 1e13 0 \\", 1);
        let error = Mesh::from_obj(damaged.as_bytes(), "a.obj", unit).expect_err("far off");
        let ObjError::Outlier { location: SourceLocation::Line(line), .. } = error else {
            panic!("{error}")
        };
        assert_eq!(line, 2 + 2 * 20);

        let header = format!("ply\nformat ascii 1.0\nelement vertex {}\n", tube.vertices().len());
        let mut ply = header + "property double x\nproperty double y\nproperty double z\n";
        ply += &format!(
            "element face {}\nproperty list uchar int vertex_index\nend_header\n",
            tube.triangles().len()
        );
        let vertex = |k: usize, v: &Point3<f64>| match k {
            20 => "3 1e13 1\n".to_owned(),
            _ => format!("{} {} {}\n", v.x, v.y, v.z),
        };
        tube.vertices().iter().enumerate().for_each(|(k, v)| ply += &vertex(k, v));
        tube.triangles().iter().for_each(|[a, b, c]| ply += &format!("3 {a} {b} {c}\n"));
        let error = Mesh::from_ply(ply.as_bytes(), "a.ply", unit).expect_err("far off");
        let PlyError::Outlier { location, vertex, .. } = error else { panic!("{error}") };
        assert_eq!((location, vertex), (SourceLocation::Line(10 + 20), 20));
    }
}
