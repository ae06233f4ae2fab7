//! Parts: triangles for proved answers, and points on them for fast ones.

use crate::error::{ReadError, refused};
use crate::pool::on_all_cores;
use numpy::{PyArray2, PyArrayMethods, PyReadonlyArray2};
use pyo3::exceptions::{PyAttributeError, PyValueError};
use pyo3::prelude::*;
use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use touchoff::certify::TriangleBvh;
use touchoff::mesh::{Geometry, GeometryError};
use touchoff::{Cloud, CloudError, FileKind, Mesh, Sampling, Unit, read_regular_file};

/// A workpiece. Its points are sampled, and its triangles sorted, when a query first needs them.
#[pyclass(frozen, module = "touchoff._touchoff")]
pub(crate) struct Part {
    pub(crate) mesh: Option<Mesh>,
    sampling: Sampling,
    points: OnceLock<Result<touchoff::Part, CloudError>>,
    triangles: OnceLock<TriangleBvh>,
    unit: Unit,
    /// The SHA-256 of the file that it was read from, as hexadecimal digits.
    digest: Option<String>,
}

/// A part as its file has it.
enum Read {
    Mesh(Mesh),
    Points(touchoff::Part),
}

/// The file extension of saved parts.
const SAVED: &str = "touchoff";

impl Read {
    /// Reads a file, unless its digest is another than the expected one. Returns the digest, too.
    fn file(path: &Path, unit: Unit, expected: Option<&str>) -> Result<(Read, String), ReadError> {
        let name = path.display().to_string();
        let is_saved = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case(SAVED));
        let unreadable = |source| GeometryError::Unreadable { file: name.clone(), source };
        let bytes = read_regular_file(path, FileKind::Geometry).map_err(unreadable)?;
        let digest: String =
            Sha256::digest(&bytes).iter().map(|byte| format!("{byte:02x}")).collect();
        if let Some(expected) = expected.filter(|expected| **expected != *digest) {
            return Err(ReadError::Changed { file: name, digest, expected: expected.to_owned() });
        }
        let read = match is_saved {
            true => Read::Points(touchoff::Part::open(path)?.converted_to(unit)),
            false => match Geometry::from_bytes(&bytes, &name, unit)? {
                Geometry::Mesh(mesh) => Read::Mesh(mesh),
                Geometry::Points(points) => {
                    Read::Points(touchoff::Part::from_cloud(&Cloud::from_points(points, unit)?))
                }
            },
        };
        Ok((read, digest))
    }
}

/// Reads a unit.
pub(crate) fn unit(name: &str) -> PyResult<Unit> {
    name.parse().map_err(|error| PyValueError::new_err(format!("unit: {error}")))
}

impl Part {
    fn of(mesh: Mesh, points: usize) -> Part {
        Part {
            unit: mesh.unit(),
            mesh: Some(mesh),
            sampling: Sampling::new(points),
            points: OnceLock::new(),
            triangles: OnceLock::new(),
            digest: None,
        }
    }

    /// Makes a part of points.
    fn of_points(points: touchoff::Part) -> Part {
        Part {
            mesh: None,
            unit: points.unit(),
            sampling: Sampling::new(points.tree().len()),
            points: OnceLock::from(Ok(points)),
            triangles: OnceLock::new(),
            digest: None,
        }
    }

    /// Returns the points.
    ///
    /// # Errors
    /// `ValueError` if they cannot be sampled.
    pub(crate) fn points(&self, py: Python<'_>) -> PyResult<&touchoff::Part> {
        let sampled = match (self.points.get(), &self.mesh) {
            (Some(sampled), _) => sampled,
            (None, Some(mesh)) => {
                let sampled = on_all_cores(py, || touchoff::Part::from_mesh(mesh, self.sampling))?;
                self.points.get_or_init(|| sampled)
            }
            (None, None) => unreachable!("a part of points has them from the beginning"),
        };
        sampled.as_ref().map_err(|error| refused(format!("points: {error}")))
    }

    /// Returns the triangles.
    ///
    /// # Errors
    /// `ValueError` for a part of points.
    pub(crate) fn triangles(&self, py: Python<'_>) -> PyResult<&TriangleBvh> {
        if let Some(triangles) = self.triangles.get() {
            return Ok(triangles);
        }
        let mesh = self.mesh()?;
        let triangles = on_all_cores(py, || TriangleBvh::new(mesh))?;
        Ok(self.triangles.get_or_init(|| triangles))
    }

    /// Returns the mesh for an attribute.
    fn shown(&self) -> PyResult<&Mesh> {
        self.mesh.as_ref().ok_or_else(|| {
            PyAttributeError::new_err("the part consists of points, and has no triangles")
        })
    }

    /// Refuses a part whose inside is unknown.
    pub(crate) fn require_inside(&self, py: Python<'_>) -> PyResult<()> {
        match self.triangles(py)?.has_inside() {
            true => Ok(()),
            false => Err(refused(
                "part: its mesh leaks, is not consistently oriented or is inside out, so that its inside is unknown: repair \
                 it, or check its surface alone by surface_only=True",
            )),
        }
    }

    pub(crate) fn mesh(&self) -> PyResult<&Mesh> {
        self.mesh.as_ref().ok_or_else(|| {
            refused("part: a certified answer needs triangles, and this part has only points: give the mesh that they were sampled from")
        })
    }
}

#[pymethods]
impl Part {
    /// Makes a part of checked arrays.
    #[new]
    fn new(
        py: Python<'_>,
        vertices: PyReadonlyArray2<'_, f64>,
        faces: PyReadonlyArray2<'_, u32>,
        unit_name: &str,
        points: usize,
    ) -> PyResult<Part> {
        let (vertices, faces) = (vertices.as_slice()?, faces.as_slice()?);
        let (vertices, _) = vertices.as_chunks::<3>();
        let (faces, _) = faces.as_chunks::<3>();
        let unit = unit(unit_name)?;
        let mesh =
            on_all_cores(py, || Mesh::new(vertices.iter().copied(), faces.iter().copied(), unit))?;
        Ok(Part::of(mesh.map_err(refused)?, points))
    }

    /// Reads a part from a file, which must have the digest, if one is given.
    #[staticmethod]
    fn read(
        py: Python<'_>,
        path: PathBuf,
        unit_name: &str,
        points: usize,
        digest: Option<&str>,
    ) -> PyResult<Part> {
        let unit = unit(unit_name)?;
        let (read, digest) = on_all_cores(py, || Read::file(&path, unit, digest))??;
        let part = match read {
            Read::Mesh(mesh) => Part::of(mesh, points),
            Read::Points(points) => Part::of_points(points),
        };
        Ok(Part { digest: Some(digest), ..part })
    }

    /// The SHA-256 of the file that it was read from, as hexadecimal digits.
    #[getter]
    fn digest(&self) -> Option<&str> {
        self.digest.as_deref()
    }

    #[getter(unit)]
    fn unit_name(&self) -> &'static str {
        self.unit.symbol()
    }

    /// The vertices, n × 3.
    #[getter]
    fn vertices<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let vertices = self.shown()?.vertices().iter().flat_map(|vertex| <[f64; 3]>::from(*vertex));
        rows(py, vertices.collect(), 3)
    }

    /// The triangles, m × 3.
    #[getter]
    fn faces<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<u32>>> {
        rows(py, self.shown()?.triangles().as_flattened().to_vec(), 3)
    }

    /// The number of triangles; 0 for points.
    #[getter]
    fn triangle_count(&self) -> usize {
        self.mesh.as_ref().map_or(0, |mesh| mesh.triangles().len())
    }

    /// The lowest and the highest corner of the box, 2 × 3.
    #[getter]
    fn bounds<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let corners = match &self.mesh {
            Some(mesh) => mesh.bounds(),
            None => {
                let tree = self.points(py)?.tree();
                let points = (0..tree.slots()).map(|slot| tree.point(slot));
                let low = points.clone().reduce(|low, point| low.inf(&point));
                let high = points.reduce(|high, point| high.sup(&point));
                [low.unwrap_or_default(), high.unwrap_or_default()]
            }
        };
        rows(py, corners.iter().flat_map(|corner| <[f64; 3]>::from(*corner)).collect(), 3)
    }

    /// Tells whether the mesh is closed and oriented outward, so that it has an inside.
    #[getter]
    fn is_solid(&self, py: Python<'_>) -> PyResult<bool> {
        let Some(mesh) = &self.mesh else { return Ok(false) };
        on_all_cores(py, || mesh.diagnostics().is_solid())
    }

    /// The findings about the mesh, or about the normals of points, a sentence each.
    #[getter]
    fn diagnostics(&self, py: Python<'_>) -> PyResult<Vec<String>> {
        match &self.mesh {
            Some(mesh) => on_all_cores(py, || mesh.diagnostics().findings()),
            None => {
                let points = self.points(py)?;
                on_all_cores(py, || points.findings())
            }
        }
    }

    /// The number of points.
    #[getter]
    fn point_count(&self, py: Python<'_>) -> PyResult<usize> {
        Ok(self.points(py)?.tree().len())
    }

    /// The largest distance of a place of the surface from the nearest point, and whether that is proved; `None` if it is
    /// unknown.
    #[getter]
    fn covering_radius(&self, py: Python<'_>) -> PyResult<Option<(f64, bool)>> {
        Ok(self.points(py)?.tree().covering_radius().map(|cover| (cover.radius, cover.proved)))
    }
}

/// Makes an array of rows.
pub(crate) fn rows<'py, T: numpy::Element>(
    py: Python<'py>,
    values: Vec<T>,
    columns: usize,
) -> PyResult<Bound<'py, PyArray2<T>>> {
    let count = values.len() / columns;
    numpy::PyArray1::from_vec(py, values).reshape([count, columns])
}
