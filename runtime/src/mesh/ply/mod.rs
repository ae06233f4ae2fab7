//! Reading PLY, ASCII and binary in both byte orders. The crate has its own reader because `ply-rs-bw`
//! silently accepts properties named twice, surplus numbers and trailing bytes. It also refuses a
//! comment that is not UTF-8 or a coordinate such as `.5`, and names no byte of a binary file.

mod error;
mod reader;
#[cfg(test)]
mod tests;

use crate::id::TriangleId;
use nalgebra::{Point3, Vector3};

use self::reader::{Body, Element, Header, Record, read_header, to_u32};
use super::faces::Faces;
use super::location::{SourceLocation, printable};
use super::outlier::{Outlier, find_outlier};
use super::{Mesh, is_valid_coordinate};
use crate::unit::Unit;

pub use self::error::PlyError;
pub(super) use self::reader::begins;

/// Names that exporters give to the list of a face's corners.
const CORNER_LISTS: [&str; 2] = ["vertex_indices", "vertex_index"];

/// Elements that describe surfaces too, but are not supported.
const UNSUPPORTED_ELEMENTS: [&[u8]; 3] = [b"tristrips", b"trifans", b"patches"];

const COORDINATE_RULE: &str = "finite and within 1e60";

/// Points of a part's surface, as read from a file.
///
/// The lists have the same, non-zero length, but for normals, of which there are none if the file has none. Coordinates are finite;
/// normals are unit vectors.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OrientedPoints {
    /// The positions of the points.
    pub points: Vec<Point3<f64>>,
    /// The outward directions, away from the material, of norm 1; empty if the file has none.
    pub normals: Vec<Vector3<f64>>,
    /// The id of the face that each point lies on, if the file contains it.
    pub triangles: Option<Vec<TriangleId>>,
    /// The area that each point represents, from 0 to 1e60, if the file contains it.
    pub areas: Option<Vec<f64>>,
    /// The number of further points of the file that are left out, because a coordinate is NaN: scanners write them where nothing
    /// was measured.
    pub left_out: usize,
}

impl OrientedPoints {
    /// Reads a PLY file's vertices as points; errors name the file as `name`. No input makes this function panic.
    ///
    /// Each vertex needs `x y z`. It may have a normal `nx ny nz`, or `normal_x normal_y normal_z` as the Point Cloud Library writes it,
    /// which is normalised because exporters round it; a `face`, the id of the face it lies on; and an `area`. Everything else,
    /// including faces, is skipped. Vertices with a coordinate NaN are left out.
    ///
    /// # Errors
    /// See [`PlyError`].
    pub fn from_ply(bytes: &[u8], name: &str) -> Result<OrientedPoints, PlyError> {
        let (header, mut body) = Body::new(bytes, name)?;
        let (vertex, [x, y, z]) = vertex(&header, name)?;
        let named = [["nx", "ny", "nz"], ["normal_x", "normal_y", "normal_z"]];
        let mut normals = named.map(|names| names.map(|name| vertex.number(name))).into_iter();
        let normal = normals.find(|normal| normal.iter().all(Option::is_some));
        let [nx, ny, nz] = normal.unwrap_or_default();
        let (face, area) = (vertex.number("face"), vertex.number("area"));
        let mut points = OrientedPoints {
            triangles: face.map(|_| Vec::new()),
            areas: area.map(|_| Vec::new()),
            ..OrientedPoints::default()
        };
        for element in &header.elements {
            if element.name != vertex.name {
                body.read(element, [], None, |_| Ok(()))?;
                continue;
            }
            body.read(element, [x, y, z, nx, ny, nz, face, area], None, |record| {
                if record.numbers[..3].iter().any(|coordinate| coordinate.is_nan()) {
                    points.left_out += 1;
                    return Ok(());
                }
                points.points.push(position(&record, name)?);
                let [_, _, _, nx, ny, nz, face, area] = record.numbers;
                if normal.is_some() {
                    let normal = Vector3::new(nx, ny, nz);
                    let norm = normal.norm();
                    // Where the square underflows, the norm is too inaccurate to divide by. NaN is not normal.
                    if !norm.is_normal() || norm * norm < f64::MIN_POSITIVE {
                        let (file, location) = (name.to_owned(), record.location);
                        let point = record.index;
                        return Err(PlyError::Normal { file, location, point, norm });
                    }
                    points.normals.push(normal / norm);
                }
                if let Some(triangles) = &mut points.triangles {
                    let rule = "a whole number, 0 or more, below 2^32";
                    let Some(face_id) = to_u32(face) else {
                        return Err(invalid_value(&record, "vertex", "face", face, rule, name));
                    };
                    triangles.push(TriangleId(face_id));
                }
                if let Some(areas) = &mut points.areas {
                    if !(is_valid_coordinate(area) && area >= 0.0) {
                        let rule = "a finite area from 0 to 1e60";
                        return Err(invalid_value(&record, "vertex", "area", area, rule, name));
                    }
                    areas.push(area);
                }
                Ok(())
            })?;
        }
        body.end()?;
        if points.points.is_empty() {
            return Err(PlyError::NoPoints { file: name.to_owned() });
        }
        match find_outlier(&points.points) {
            None => Ok(points),
            Some(found) => Err(outlier_vertex(bytes, name, found.index, found.outlier)),
        }
    }
}

impl Mesh {
    /// Reads a PLY file's faces as a mesh, whose numbers are in `unit` (PLY states none); errors name
    /// the file as `name`. No input makes this function panic.
    ///
    /// A face with more than three corners is divided into a fan of triangles from its first corner, or cut at its ears if the
    /// fan does not fill it, and refused if it crosses itself; ids count the resulting triangles. Corners with equal coordinates become one vertex, as in
    /// [`Mesh::read_stl`], because exporters double the vertices of sharp edges. Other elements and properties are
    /// skipped, except triangle strips and a second list of corners, which are refused.
    ///
    /// # Errors
    /// See [`PlyError`].
    pub fn from_ply(bytes: &[u8], name: &str, unit: Unit) -> Result<Mesh, PlyError> {
        let (header, mut body) = Body::new(bytes, name)?;
        let file = name.to_owned();
        let (vertex, xyz) = vertex(&header, name)?;
        let face = header.element("face");
        let list = face.and_then(|face| {
            let name = CORNER_LISTS.into_iter().find(|name| face.list(name).is_some())?;
            Some((face, name))
        });
        let Some((face, list)) = list else {
            return Err(PlyError::NoFaces { file });
        };
        let strips =
            header.elements.iter().find(|element| UNSUPPORTED_ELEMENTS.contains(&element.name));
        // The file does not say which of two lists is the surface.
        let second =
            CORNER_LISTS.into_iter().find(|other| *other != list && face.list(other).is_some());
        let unread = strips.map(|strips| printable(strips.name)).or(second.map(str::to_owned));
        if let Some(unread) = unread {
            return Err(PlyError::Unread { file, unread });
        }
        let mut vertices = Vec::new();
        let mut faces = Faces::default();
        let mut corners = Vec::new();
        for element in &header.elements {
            if element.name == vertex.name {
                body.read(element, xyz, None, |record| {
                    vertices.push(position(&record, name)?);
                    Ok(())
                })?;
            } else if element.name == face.name {
                body.read(element, [], element.list(list), |record| {
                    corners_of(&record, list, vertex.count, name, &mut corners)?;
                    faces.push(record.location, &corners);
                    Ok(())
                })?;
            } else {
                body.read(element, [], None, |_| Ok(()))?;
            }
        }
        body.end()?;
        if faces.is_empty() {
            return Err(PlyError::NoFaces { file });
        }
        if let Some(location) = faces.fill(&vertices) {
            return Err(PlyError::Folded { file, location });
        }
        if let Some((vertex, outlier)) = faces.outlier(&vertices) {
            return Err(outlier_vertex(bytes, name, vertex, outlier));
        }
        let mesh = faces.weld(&vertices, unit);
        mesh.map_err(|source| PlyError::Mesh { file, source })
    }
}

/// Returns the error for a vertex far outside the others in a valid file, which is read once more to locate the vertex.
fn outlier_vertex(bytes: &[u8], name: &str, vertex: usize, outlier: Outlier) -> PlyError {
    match location_of_vertex(bytes, name, vertex) {
        Ok(Some(location)) => {
            PlyError::Outlier { file: name.to_owned(), location, vertex, outlier }
        }
        Ok(None) => PlyError::NoPoints { file: name.to_owned() },
        Err(error) => error,
    }
}

/// Returns the location of a vertex, if the file has it.
fn location_of_vertex(
    bytes: &[u8],
    name: &str,
    vertex: usize,
) -> Result<Option<SourceLocation>, PlyError> {
    let (header, mut body) = Body::new(bytes, name)?;
    let mut location = None;
    for element in &header.elements {
        body.read(element, [], None, |record: Record<0>| {
            if element.name == b"vertex" && record.index == vertex {
                location = Some(record.location);
            }
            Ok(())
        })?;
    }
    Ok(location)
}

/// Returns whether a PLY file holds faces; if so it is a mesh, otherwise points.
pub(super) fn has_faces(bytes: &[u8], name: &str) -> Result<bool, PlyError> {
    let (header, _) = read_header(bytes, name)?;
    Ok(header.element("face").is_some_and(|face| face.count > 0))
}

/// Returns the vertex element and the indices of its coordinate properties.
fn vertex<'h, 'a>(
    header: &'h Header<'a>,
    name: &str,
) -> Result<(&'h Element<'a>, [Option<usize>; 3]), PlyError> {
    if let Some(vertex) = header.element("vertex").filter(|vertex| vertex.count > 0)
        && let xyz @ [Some(_), Some(_), Some(_)] = ["x", "y", "z"].map(|name| vertex.number(name))
    {
        return Ok((vertex, xyz));
    }
    Err(PlyError::NoPoints { file: name.to_owned() })
}

/// Returns the position of a vertex, from the first three numbers of its record.
fn position<const N: usize>(record: &Record<N>, name: &str) -> Result<Point3<f64>, PlyError> {
    let axes = ["x", "y", "z"].iter().zip(record.numbers);
    for (axis, coordinate) in axes.clone() {
        if !is_valid_coordinate(coordinate) {
            return Err(invalid_value(record, "vertex", axis, coordinate, COORDINATE_RULE, name));
        }
    }
    let mut position = Point3::origin();
    position.iter_mut().zip(axes).for_each(|(target, (_, coordinate))| *target = coordinate);
    Ok(position)
}

/// Collects the vertex indices of a face and checks them against the number of vertices.
fn corners_of(
    record: &Record<0>,
    list: &str,
    vertices: usize,
    name: &str,
    corners: &mut Vec<u32>,
) -> Result<(), PlyError> {
    let (file, location, face) = (name.to_owned(), record.location, record.index);
    corners.clear();
    for &item in record.items {
        let Some(vertex) = to_u32(item) else {
            let rule = "the number of a vertex, counted from 0";
            return Err(invalid_value(record, "face", list, item, rule, name));
        };
        if vertex as usize >= vertices {
            return Err(PlyError::Index { file, location, face, vertex, vertices });
        }
        corners.push(vertex);
    }
    match corners.len() {
        0..=2 => Err(PlyError::Corners { file, location, face, corners: corners.len() }),
        _ => Ok(()),
    }
}

fn invalid_value<const N: usize>(
    record: &Record<N>,
    element: &str,
    property: &str,
    value: f64,
    rule: &'static str,
    name: &str,
) -> PlyError {
    PlyError::Value {
        file: name.to_owned(),
        location: record.location,
        element: element.to_owned(),
        index: record.index,
        property: property.to_owned(),
        value,
        rule,
    }
}
