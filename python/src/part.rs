//! Parts: triangles for proved answers, and points on them for fast ones.

use crate::error::{geometry, refused};
use crate::pool::on_all_cores;
use numpy::{PyArray2, PyArrayMethods, PyReadonlyArray2};
use pyo3::exceptions::{PyAttributeError, PyValueError};
use pyo3::prelude::*;
use std::path::PathBuf;
use std::sync::OnceLock;
use touchoff::certify::TriangleBvh;
use touchoff::mesh::Geometry;
use touchoff::{Cloud, CloudError, Mesh, Sampling, Unit};

/// A workpiece. Its points are sampled, and its triangles sorted, when a query first needs them.
#[pyclass(frozen, module = "touchoff._touchoff")]
pub(crate) struct Part {
    mesh: Option<Mesh>,
    sampling: Sampling,
    points: OnceLock<Result<touchoff::Part, CloudError>>,
    triangles: OnceLock<TriangleBvh>,
    unit: Unit,
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
        }
    }

    /// Returns the points.
    ///
    /// # Errors
    /// `ValueError` if they cannot be sampled.
    pub(crate) fn points(&self) -> PyResult<&touchoff::Part> {
        let sampled = match (self.points.get(), &self.mesh) {
            (Some(sampled), _) => sampled,
            (None, Some(mesh)) => {
                let sampled = on_all_cores(|| touchoff::Part::from_mesh(mesh, self.sampling))?;
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
    pub(crate) fn triangles(&self) -> PyResult<&TriangleBvh> {
        if let Some(triangles) = self.triangles.get() {
            return Ok(triangles);
        }
        let mesh = self.mesh()?;
        let triangles = on_all_cores(|| TriangleBvh::new(mesh))?;
        Ok(self.triangles.get_or_init(|| triangles))
    }

    /// Returns the mesh for an attribute.
    fn shown(&self) -> PyResult<&Mesh> {
        self.mesh.as_ref().ok_or_else(|| {
            PyAttributeError::new_err("the part consists of points, and has no triangles")
        })
    }

    /// Refuses a part whose inside is unknown.
    pub(crate) fn require_inside(&self) -> PyResult<()> {
        match self.triangles()?.has_inside() {
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
        vertices: PyReadonlyArray2<'_, f64>,
        faces: PyReadonlyArray2<'_, u32>,
        unit_name: &str,
        points: usize,
    ) -> PyResult<Part> {
        let (vertices, faces) = (vertices.as_slice()?, faces.as_slice()?);
        let (vertices, _) = vertices.as_chunks::<3>();
        let (faces, _) = faces.as_chunks::<3>();
        let mesh = Mesh::new(vertices.iter().copied(), faces.iter().copied(), unit(unit_name)?);
        Ok(Part::of(mesh.map_err(refused)?, points))
    }

    /// Reads a part from a file.
    #[staticmethod]
    fn read(py: Python<'_>, path: PathBuf, unit_name: &str, points: usize) -> PyResult<Part> {
        let unit = unit(unit_name)?;
        let read = py.detach(|| on_all_cores(|| Geometry::read(&path, unit)))?.map_err(geometry)?;
        match read {
            Geometry::Mesh(mesh) => Ok(Part::of(mesh, points)),
            Geometry::Points(points) => {
                let cloud = Cloud::from_points(points, unit).map_err(refused)?;
                let sampling = Sampling::new(cloud.len());
                let points = OnceLock::from(Ok(touchoff::Part::from_cloud(&cloud)));
                Ok(Part { mesh: None, sampling, points, triangles: OnceLock::new(), unit })
            }
        }
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
                let tree = self.points()?.tree();
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
    fn is_solid(&self) -> bool {
        self.mesh.as_ref().is_some_and(|mesh| mesh.diagnostics().is_solid())
    }

    /// The findings about the mesh, a sentence each.
    #[getter]
    fn diagnostics(&self) -> Vec<String> {
        self.mesh.as_ref().map_or(Vec::new(), |mesh| mesh.diagnostics().findings())
    }

    /// The number of points.
    #[getter]
    fn point_count(&self, py: Python<'_>) -> PyResult<usize> {
        Ok(py.detach(|| self.points())?.tree().len())
    }

    /// The largest distance of a place of the surface from the nearest point, and whether that is proved; `None` if it is
    /// unknown.
    #[getter]
    fn covering_radius(&self, py: Python<'_>) -> PyResult<Option<(f64, bool)>> {
        let points = py.detach(|| self.points())?;
        Ok(points.tree().covering_radius().map(|cover| (cover.radius, cover.proved)))
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
