//! Outlying coordinates, as damaged files have them.

use std::fmt;

use nalgebra::Point3;

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

/// Finds the first vertex that is more than 2^24 times as far from the median of all vertices as three
/// quarters of them are. Returns its index, the axis along which it is farthest, and the outlier.
/// Coordinates must be finite.
pub(super) fn find_outlier(vertices: &[Point3<f64>]) -> Option<(usize, usize, Outlier)> {
    if vertices.is_empty() {
        return None;
    }
    let mut scratch: Vec<f64> = Vec::with_capacity(vertices.len());
    let mut nth = |values: &mut dyn Iterator<Item = f64>, index: usize| {
        scratch.clear();
        scratch.extend(values);
        *scratch.select_nth_unstable_by(index, f64::total_cmp).1
    };
    let count = vertices.len();
    let median =
        Point3::from([0, 1, 2].map(|axis| nth(&mut vertices.iter().map(|v| v[axis]), count / 2)));
    let distance = |vertex: &Point3<f64>| (vertex - median).amax();
    let rest = nth(&mut vertices.iter().map(distance), 3 * count / 4);
    if rest == 0.0 {
        return None;
    }
    let is_outlier = |vertex: &&Point3<f64>| distance(vertex) > OUTLIER_DISTANCE_RATIO * rest;
    let first = vertices.iter().position(|vertex| is_outlier(&vertex))?;
    let axis = (vertices[first] - median).iamax();
    let count = vertices.iter().filter(is_outlier).count();
    Some((first, axis, Outlier { coordinate: vertices[first][axis], rest, count }))
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
        assert_eq!((found.0, found.1, found.2.coordinate, found.2.count), (7, 2, -1e13, 1));
        assert!(found.2.rest < 40.0);
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
