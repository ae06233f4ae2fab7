//! What a mesh is, in numbers and in sentences: whether it is a solid, which way its triangles
//! face, and what about it will surprise.

use std::fmt;

use super::topology::{Edges, shells};
use super::{Mesh, Sum, area_and_normal};
use crate::unit::Unit;

/// What [`Mesh::survey`] found.
///
/// A surface has an inside when the winding number, how often it goes around a point, is a whole
/// number at every point off it. That is so just when the mesh is [`closed`](Survey::closed) and
/// [`oriented`](Survey::oriented): each edge is used as often one way as the other. Only then can
/// it be known whether a tool is wholly inside the material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Survey {
    /// The mesh's unit of length.
    pub unit: Unit,
    /// How many triangles there are, those without area included.
    pub triangles: usize,
    /// How many of them have no area, or are too thin to have a normal.
    pub degenerate: usize,
    /// The surface area, in the unit's square.
    pub area: f64,
    /// The signed volume, in the unit's cube, by the divergence theorem about the middle of the
    /// bounding box: negative when the mesh is inside out, 0 when it is within rounding of it.
    /// It means something only for a closed and oriented mesh.
    pub volume: f64,
    /// Edges where a surface ends: used by one triangle (or by another odd number of them).
    pub open_edges: usize,
    /// Edges where the surface does not end, but whose triangles disagree on which side is out:
    /// used by two of them in the same direction, where neighbours use it in opposite ones.
    pub crossed_edges: usize,
    /// Edges used by more than two triangles. Where two solids touch along an edge this is in
    /// order; such edges count as open or crossed too when they are.
    pub shared_edges: usize,
    /// Facets of an STL file whose stated normal is more than 120° from that of their winding,
    /// which is the one in use.
    pub opposed_normals: usize,
    /// Pieces that share no vertex with each other.
    pub shells: usize,
    /// Shells with a negative volume, in a closed and oriented mesh: voids in the material, or
    /// pieces that are inside out. 0 in other meshes.
    pub inverted_shells: usize,
}

impl Survey {
    /// The same of the mesh in another unit.
    pub(crate) fn to(self, unit: Unit) -> Survey {
        let factor = self.unit.to(unit);
        let (area, volume) = (self.area * factor.powi(2), self.volume * factor.powi(3));
        Survey { unit, area, volume, ..self }
    }

    pub(super) fn of(mesh: &Mesh) -> Survey {
        let edges = Edges::of(mesh);
        let (shell_of, shells) = shells(mesh);
        let [low, high] = mesh.bounds();
        let origin = nalgebra::center(&low, &high);

        let mut degenerate = 0;
        let (mut area, mut volume) = (Sum::default(), Sum::default());
        let mut shell_areas = vec![0.0; shells];
        let mut shell_volumes = vec![0.0; shells];
        for (corners, triangle) in mesh.corners().zip(mesh.triangles()) {
            let Some((share, normal)) = area_and_normal(&corners) else {
                degenerate += 1;
                continue;
            };
            let cone = normal.dot(&(corners[0] - origin)) * share / 3.0;
            area.add(share);
            volume.add(cone);
            let shell = shell_of[triangle[0] as usize] as usize;
            shell_areas[shell] += share;
            shell_volumes[shell] += cone;
        }

        // Each cone's rounding error is a few epsilon times its area times its height, so a
        // volume below this is as good as none, and its sign says nothing.
        let rounding = 16.0 * f64::EPSILON * nalgebra::distance(&low, &high);
        let area = area.value();
        let volume = Some(volume.value()).filter(|v| v.abs() > rounding * area).unwrap_or(0.0);
        let sums = shell_volumes.iter().zip(&shell_areas);
        let inverted = sums.filter(|&(v, a)| *v < -rounding * a).count();
        let has_sides = edges.open == 0 && edges.crossed == 0;
        Survey {
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

    /// Whether the surface ends nowhere.
    pub fn closed(&self) -> bool {
        self.open_edges == 0
    }

    /// Whether neighbouring triangles agree on which side is out.
    pub fn oriented(&self) -> bool {
        self.crossed_edges == 0
    }

    /// Whether the mesh is closed and oriented, but the wrong way: its normals point into the
    /// material.
    pub fn inside_out(&self) -> bool {
        self.closed() && self.oriented() && self.volume < 0.0
    }

    /// Whether the mesh bounds a solid: closed, oriented, on the whole with its normals out of
    /// the material. Only then is it known what is inside. Whether inverted shells are voids or
    /// mistakes, and whether shells cross, it does not tell.
    pub fn solid(&self) -> bool {
        self.closed() && self.oriented() && self.volume > 0.0
    }

    /// What was found, in sentences: first what the mesh is, then each thing to know about it.
    /// A mesh with nothing odd has one.
    pub fn findings(&self) -> Vec<String> {
        let mut findings = vec![self.summary()];
        let mut note = |count: usize, thing: &str, text: &str| {
            if count > 0 {
                findings.push(format!("{}{text}", counted(count, thing)));
            }
        };
        note(
            self.open_edges,
            "open edge",
            ": the mesh leaks; whether a tool is wholly inside cannot be known",
        );
        note(
            self.crossed_edges,
            "edge",
            " where neighbouring triangles disagree on which side is out; which way the part \
             pushes back there cannot be trusted",
        );
        note(
            self.shared_edges,
            "edge",
            " shared by more than two triangles: surfaces touch or cross there",
        );
        if self.inside_out() {
            note(
                self.triangles,
                "triangle",
                ", all facing inward: the part would pull the tool in; flip the mesh's normals \
                 where it was made",
            );
        } else {
            note(
                self.inverted_shells,
                "inward-facing shell",
                ": a void in the material, or a piece that is inside out",
            );
        }
        note(
            self.opposed_normals,
            "facet",
            " whose normal in the file opposes the order of its corners; the order is what counts",
        );
        note(
            self.degenerate,
            "triangle",
            " without area: nothing can touch them, the numbering of the others stays",
        );
        findings
    }

    fn summary(&self) -> String {
        let state = match (self.closed(), self.oriented()) {
            (false, _) => "open",
            (true, false) => "closed, not consistently oriented",
            (true, true) if self.volume > 0.0 => "closed, oriented outward",
            (true, true) if self.volume < 0.0 => "closed, inside out",
            (true, true) => "closed, but it encloses nothing",
        };
        let pieces = match self.shells {
            0 | 1 => String::new(),
            shells => format!(" in {}", counted(shells, "shell")),
        };
        let (triangles, unit) = (counted(self.triangles, "triangle"), self.unit);
        let area = figure(self.area);
        let volume = match (self.closed() && self.oriented()).then_some(self.volume.abs()) {
            Some(volume) if volume > 0.0 => format!(", volume {} {unit}³", figure(volume)),
            _ => String::new(),
        };
        format!("{state}: {triangles}{pieces}, area {area} {unit}²{volume}")
    }
}

impl fmt::Display for Survey {
    /// The [`findings`](Survey::findings), one to a line.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.findings().join("\n"))
    }
}

/// `1 open edge`, `52,872 triangles`.
fn counted(count: usize, thing: &str) -> String {
    let digits = count.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    let plural = if count == 1 { "" } else { "s" };
    format!("{text} {thing}{plural}")
}

/// Six significant figures, or all of a longer whole number.
fn figure(value: f64) -> String {
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

    /// The cube from 0 to 1 after a change to its triangles.
    fn changed(change: impl FnOnce(&mut Vec<[u32; 3]>)) -> Survey {
        let cube = cube(0.0, 1.0);
        let mut triangles = cube.triangles().to_vec();
        change(&mut triangles);
        Mesh::new(cube.vertices().to_vec(), triangles, cube.unit()).expect("a mesh").survey()
    }

    #[test]
    fn a_solid_has_nothing_odd() {
        let survey = cube(-2.0, 3.0).survey();
        assert!(survey.solid() && !survey.inside_out());
        assert_eq!((survey.area, survey.volume, survey.shells), (150.0, 125.0, 1));
        let text = "closed, oriented outward: 12 triangles, area 150 mm², volume 125 mm³";
        assert_eq!(survey.findings(), [text]);
        // Far from the origin the volume loses only what the coordinates themselves lost.
        assert_eq!(cube(1e9, 1e9 + 1.0).survey().volume, 1.0);
    }

    #[test]
    fn finds_leaks_and_turned_triangles() {
        let open = changed(|triangles| triangles.truncate(11));
        assert!((open.open_edges, open.closed(), open.solid()) == (3, false, false));
        assert!(open.to_string().starts_with("open: 11 triangles, area 5.5 mm²\n3 open edges: "));

        let turned = changed(|triangles| triangles[0].swap(0, 1));
        assert_eq!((turned.open_edges, turned.crossed_edges), (0, 3));
        assert!(turned.closed() && !turned.oriented() && !turned.solid());
        assert!(turned.to_string().starts_with("closed, not consistently oriented: "));

        let inside_out = changed(|triangles| triangles.iter_mut().for_each(|t| t.swap(0, 1)));
        assert!(inside_out.inside_out() && !inside_out.solid());
        assert_eq!(inside_out.volume, -1.0);
        assert!(inside_out.to_string().contains("12 triangles, all facing inward"));
    }

    #[test]
    fn finds_what_is_empty_and_what_is_doubled() {
        let collapsed = changed(|triangles| triangles.extend([[0, 0, 1], [5, 5, 5]]));
        assert!(collapsed.solid() && collapsed.degenerate == 2);
        let flat = changed(|triangles| *triangles = vec![[0, 1, 2], [2, 1, 0]]);
        assert!(flat.closed() && flat.volume == 0.0 && !flat.solid() && !flat.inside_out());
        assert!(flat.to_string().starts_with("closed, but it encloses nothing"));
        let fin = changed(|triangles| triangles.push([0, 4, 7]));
        assert_eq!((fin.shared_edges, fin.open_edges), (2, 3));
    }

    #[test]
    fn tells_shells_and_voids() {
        let (outer, inner) = (cube(0.0, 3.0), cube(1.0, 2.0));
        let vertices = [outer.vertices(), inner.vertices()].concat();
        let hollow = inner.triangles().iter().map(|&[a, b, c]| [a + 8, c + 8, b + 8]);
        let triangles = outer.triangles().iter().copied().chain(hollow).collect();
        let survey = Mesh::new(vertices, triangles, Unit::Inch).expect("a mesh").survey();
        assert_eq!((survey.shells, survey.inverted_shells, survey.volume), (2, 1, 26.0));
        assert!(survey.solid());
        let text = survey.to_string();
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
        let survey = Mesh::from_stl(&bytes, "", Unit::Millimetre).expect("read").survey();
        assert!(survey.solid() && survey.opposed_normals == 1);
        assert!(survey.to_string().contains("1 facet whose normal in the file opposes"));
    }

    #[test]
    fn writes_numbers_to_be_read() {
        assert_eq!(counted(1, "edge"), "1 edge");
        assert_eq!(counted(1_052_872, "edge"), "1,052,872 edges");
        let figures = [1.0 / 3.0, 759.6188, 1234567.8, 1e12, 2e-9].map(figure);
        assert_eq!(figures, ["0.333333", "759.619", "1234568", "1.00000e12", "2.00000e-9"]);
    }
}
