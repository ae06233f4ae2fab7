//! Diagnostics of a mesh as numbers and sentences: closed or open, orientation, shells, and irregularities.

use crate::mesh::topology::{Edges, cone_volume, shells};
use crate::mesh::{CompensatedSum, Mesh, area_and_normal};
use crate::unit::Unit;
use std::fmt;

/// The result of [`Mesh::diagnostics`].
///
/// A surface has an inside if the winding number (the number of times it goes around a point) is an integer at every
/// point off it. This holds exactly if the mesh is [`closed`](MeshDiagnostics::is_closed) and
/// [`oriented`](MeshDiagnostics::is_oriented): each edge is used equally often in both directions. Only then can it be
/// decided whether a tool is wholly inside the material.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct MeshDiagnostics {
    /// The mesh's unit of length.
    pub unit: Unit,
    /// The number of triangles, including those without area.
    pub triangles: usize,
    /// The number of triangles that have no area or are too thin to have a normal.
    pub degenerate: usize,
    /// The surface area, in the square of the unit.
    pub area: f64,
    /// The signed volume, in the cube of the unit, by the divergence theorem about the centre of the
    /// bounding box. It is negative if the mesh is inside out and 0 if it is within its rounding error.
    /// It is meaningful only for a closed and oriented mesh.
    pub volume: f64,
    /// Edges where a surface ends: used by one triangle, or by another odd number of them.
    pub open_edges: usize,
    /// Edges where the surface does not end, but whose triangles disagree on the outward side. Two triangles use such
    /// an edge in the same direction, where consistently oriented neighbours use it in opposite ones.
    pub crossed_edges: usize,
    /// Edges used by more than two triangles. This is valid where two solids touch along an edge. Such
    /// edges also count as open or crossed if they are.
    pub shared_edges: usize,
    /// Facets of an STL file whose stated normal is more than 120° from the normal of their winding. The
    /// winding's normal is the one in use.
    pub opposed_normals: usize,
    /// Connected pieces: triangles that share a vertex belong to the same shell.
    pub shells: usize,
    /// Shells with a negative volume, in a closed and oriented mesh: voids in the material, or pieces
    /// that are inside out. 0 in other meshes.
    pub inverted_shells: usize,
}

impl MeshDiagnostics {
    /// Converts the diagnostics to another unit.
    pub(crate) fn to(self, unit: Unit) -> MeshDiagnostics {
        let factor = self.unit.factor_to(unit);
        let (area, volume) = (self.area * factor.powi(2), self.volume * factor.powi(3));
        MeshDiagnostics { unit, area, volume, ..self }
    }

    pub(super) fn of(mesh: &Mesh) -> MeshDiagnostics {
        let edges = Edges::of(mesh);
        let (shell_of, shells) = shells(mesh);
        let [low, high] = mesh.bounds();
        let origin = nalgebra::center(&low, &high);

        let mut degenerate = 0;
        let (mut area, mut volume) = (CompensatedSum::default(), CompensatedSum::default());
        let mut shell_areas = vec![0.0; shells];
        let mut shell_volumes = vec![0.0; shells];
        for (corners, triangle) in mesh.corners().zip(mesh.triangles()) {
            let Some((triangle_area, normal)) = area_and_normal(&corners) else {
                degenerate += 1;
                continue;
            };
            let cone = cone_volume(&corners, triangle_area, &normal, &origin);
            area.add(triangle_area);
            volume.add(cone);
            let shell = shell_of[triangle[0] as usize] as usize;
            shell_areas[shell] += triangle_area;
            shell_volumes[shell] += cone;
        }

        // Each cone's rounding error is a few epsilon times its area times its height. A volume below
        // this bound is indistinguishable from zero, and its sign is meaningless.
        let rounding = 16.0 * f64::EPSILON * nalgebra::distance(&low, &high);
        let area = area.value();
        let volume = volume.value();
        let volume = if volume.abs() > rounding * area { volume } else { 0.0 };
        let sums = shell_volumes.iter().zip(&shell_areas);
        let inverted = sums.filter(|&(volume, a)| *volume < -rounding * a).count();
        let has_sides = edges.open == 0 && edges.crossed == 0;
        MeshDiagnostics {
            unit: mesh.unit(),
            triangles: mesh.triangles().len(),
            degenerate,
            area,
            volume,
            open_edges: edges.open,
            crossed_edges: edges.crossed,
            shared_edges: edges.shared,
            opposed_normals: mesh.opposed_normals,
            shells,
            inverted_shells: if has_sides { inverted } else { 0 },
        }
    }

    /// Returns whether the surface ends nowhere.
    pub fn is_closed(&self) -> bool {
        self.open_edges == 0
    }

    /// Returns whether neighbouring triangles agree on the outward side.
    pub fn is_oriented(&self) -> bool {
        self.crossed_edges == 0
    }

    /// Returns whether the mesh is closed and oriented, but with its normals into the material.
    pub fn is_inside_out(&self) -> bool {
        self.is_closed() && self.is_oriented() && self.volume < 0.0
    }

    /// Returns whether the mesh bounds a solid: closed, oriented, and on the whole with its normals out
    /// of the material. Only then is the inside defined. The result does not tell whether inverted
    /// shells are voids or mistakes, nor whether shells intersect.
    pub fn is_solid(&self) -> bool {
        self.is_closed() && self.is_oriented() && self.volume > 0.0
    }

    /// Returns the findings as sentences: first the kind of mesh, then each irregularity. A mesh without
    /// irregularities has one sentence.
    pub fn findings(&self) -> Vec<String> {
        // Where all triangles face inward, no shell stands out.
        let (inward, inward_noun, inward_text) = if self.is_inside_out() {
            (
                self.triangles,
                "triangle",
                ", all facing inward: the part would pull the tool in; flip the mesh's normals \
                 where it was made",
            )
        } else {
            (
                self.inverted_shells,
                "inward-facing shell",
                ": a void in the material, or a piece that is inside out",
            )
        };
        let irregularities = [
            (
                self.open_edges,
                "open edge",
                ": the mesh leaks; whether a tool is wholly inside cannot be known",
            ),
            (
                self.crossed_edges,
                "edge",
                " where neighbouring triangles disagree on which side is out; which way the part \
                 pushes back there cannot be trusted",
            ),
            (
                self.shared_edges,
                "edge",
                " shared by more than two triangles: surfaces touch or cross there",
            ),
            (inward, inward_noun, inward_text),
            (
                self.opposed_normals,
                "facet",
                " whose normal in the file opposes the order of its corners; the order is what counts",
            ),
            (
                self.degenerate,
                "triangle",
                " without area: nothing can touch them, the numbering of the others stays",
            ),
        ];
        let present = irregularities.into_iter().filter(|(count, ..)| *count > 0);
        let sentences =
            present.map(|(count, noun, text)| format!("{}{text}", format_count(count, noun)));
        [self.summary()].into_iter().chain(sentences).collect()
    }

    fn summary(&self) -> String {
        let state = match (self.is_closed(), self.is_oriented()) {
            (false, _) => "open",
            (true, false) => "closed, not consistently oriented",
            (true, true) if self.volume > 0.0 => "closed, oriented outward",
            (true, true) if self.volume < 0.0 => "closed, inside out",
            (true, true) => "closed, but it encloses nothing",
        };
        let shell_text = match self.shells {
            0 | 1 => String::new(),
            shells => format!(" in {}", format_count(shells, "shell")),
        };
        let (triangles, unit) = (format_count(self.triangles, "triangle"), self.unit);
        let area = format_number(self.area);
        let volume = match (self.is_closed() && self.is_oriented()).then_some(self.volume.abs()) {
            Some(volume) if volume > 0.0 => format!(", volume {} {unit}³", format_number(volume)),
            _ => String::new(),
        };
        format!("{state}: {triangles}{shell_text}, area {area} {unit}²{volume}")
    }
}

impl fmt::Display for MeshDiagnostics {
    /// Writes the [`findings`](MeshDiagnostics::findings), one per line.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.findings().join("\n"))
    }
}

/// Formats a count with thousands separators and its noun: `1 open edge`, `52,872 triangles`.
fn format_count(count: usize, noun: &str) -> String {
    let digits = count.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    let plural = if count == 1 { "" } else { "s" };
    format!("{text} {noun}{plural}")
}

/// Formats a number with six significant figures, or with all digits of a longer whole number.
fn format_number(value: f64) -> String {
    let exponent = value.abs().log10().floor();
    if !(-4.0..9.0).contains(&exponent) {
        return format!("{value:.5e}");
    }
    let decimals = (5.0 - exponent).max(0.0) as usize;
    let text = format!("{value:.decimals$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

#[cfg(test)]
mod tests {
    use super::super::shapes;
    use super::*;
    use nalgebra::Point3;

    fn cube(low: f64, high: f64) -> Mesh {
        let [low, high] = [low, high].map(|c| Point3::new(c, c, c));
        shapes::cuboid(low, high, Unit::Millimetre).expect("a cube")
    }

    /// Returns the diagnostics of the cube from 0 to 1 after a change to its triangles.
    fn diagnostics_after(change: impl FnOnce(&mut Vec<[u32; 3]>)) -> MeshDiagnostics {
        let cube = cube(0.0, 1.0);
        let mut triangles = cube.triangles().to_vec();
        change(&mut triangles);
        Mesh::new(cube.vertices().to_vec(), triangles, cube.unit()).expect("a mesh").diagnostics()
    }

    #[test]
    fn a_solid_has_no_irregularities() {
        let diagnostics = cube(-2.0, 3.0).diagnostics();
        assert!(diagnostics.is_solid() && !diagnostics.is_inside_out());
        assert_eq!((diagnostics.area, diagnostics.volume, diagnostics.shells), (150.0, 125.0, 1));
        let text = "closed, oriented outward: 12 triangles, area 150 mm², volume 125 mm³";
        assert_eq!(diagnostics.findings(), [text]);
        // Far from the origin the volume loses only the rounding of the coordinates themselves.
        assert_eq!(cube(1e9, 1e9 + 1.0).diagnostics().volume, 1.0);
    }

    #[test]
    fn finds_leaks_and_turned_triangles() {
        let open = diagnostics_after(|triangles| triangles.truncate(11));
        assert!((open.open_edges, open.is_closed(), open.is_solid()) == (3, false, false));
        assert!(open.to_string().starts_with("open: 11 triangles, area 5.5 mm²\n3 open edges: "));

        let turned = diagnostics_after(|triangles| triangles[0].swap(0, 1));
        assert_eq!((turned.open_edges, turned.crossed_edges), (0, 3));
        assert!(turned.is_closed() && !turned.is_oriented() && !turned.is_solid());
        assert!(turned.to_string().starts_with("closed, not consistently oriented: "));

        let inside_out =
            diagnostics_after(|triangles| triangles.iter_mut().for_each(|t| t.swap(0, 1)));
        assert!(inside_out.is_inside_out() && !inside_out.is_solid());
        assert_eq!(inside_out.volume, -1.0);
        assert!(inside_out.to_string().contains("12 triangles, all facing inward"));
    }

    #[test]
    fn finds_degenerate_flat_and_shared_triangles() {
        let collapsed = diagnostics_after(|triangles| triangles.extend([[0, 0, 1], [5, 5, 5]]));
        assert!(collapsed.is_solid() && collapsed.degenerate == 2);
        let flat = diagnostics_after(|triangles| *triangles = vec![[0, 1, 2], [2, 1, 0]]);
        assert!(
            flat.is_closed() && flat.volume == 0.0 && !flat.is_solid() && !flat.is_inside_out()
        );
        assert!(flat.to_string().starts_with("closed, but it encloses nothing"));
        let fin = diagnostics_after(|triangles| triangles.push([0, 4, 7]));
        assert_eq!((fin.shared_edges, fin.open_edges), (2, 3));
    }

    #[test]
    fn distinguishes_shells_and_voids() {
        let (outer, inner) = (cube(0.0, 3.0), cube(1.0, 2.0));
        let vertices = [outer.vertices(), inner.vertices()].concat();
        let hollow = inner.triangles().iter().map(|&[a, b, c]| [a + 8, c + 8, b + 8]);
        let triangles = outer.triangles().iter().copied().chain(hollow);
        let diagnostics = Mesh::new(vertices, triangles, Unit::Inch).expect("a mesh").diagnostics();
        assert_eq!(
            (diagnostics.shells, diagnostics.inverted_shells, diagnostics.volume),
            (2, 1, 26.0)
        );
        assert!(diagnostics.is_solid());
        let text = diagnostics.to_string();
        assert!(
            text.contains("24 triangles in 2 shells, area 60 inch², volume 26 inch³"),
            "{text}"
        );
        assert!(text.contains("1 inward-facing shell: a void"), "{text}");
    }

    #[test]
    fn counts_normals_that_oppose_their_winding() {
        let mut bytes = Vec::new();
        cube(0.0, 1.0).write_stl(&mut bytes).expect("written");
        let z = bytes[84 + 50 * 11 + 8..].first_chunk_mut::<4>().expect("the last normal's z");
        *z = (-1f32).to_le_bytes();
        let diagnostics = Mesh::from_stl(&bytes, "", Unit::Millimetre).expect("read").diagnostics();
        assert!(diagnostics.is_solid() && diagnostics.opposed_normals == 1);
        assert!(diagnostics.to_string().contains("1 facet whose normal in the file opposes"));
    }

    #[test]
    fn formats_counts_and_numbers() {
        assert_eq!(format_count(1, "edge"), "1 edge");
        assert_eq!(format_count(1_052_872, "edge"), "1,052,872 edges");
        let formatted = [1.0 / 3.0, 759.6188, 1234567.8, 1e12, 2e-9].map(format_number);
        assert_eq!(formatted, ["0.333333", "759.619", "1234568", "1.00000e12", "2.00000e-9"]);
    }
}
