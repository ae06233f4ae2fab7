//! Pieces of triangles: how much area a sweep colours wrongly, beside a mesh that is finely subdivided.

use nalgebra::Point3;
use std::collections::HashMap;
use std::num::NonZeroU16;
use std::ops::ControlFlow;
use std::sync::LazyLock;
use std::time::Instant;
use touchoff::certify::TriangleBvh;
use touchoff::tool::Interpreted;
use touchoff::{Mesh, Tool, TriangleId, Unit};
use touchoff_postures::sweep::{
    BATCH_TRIANGLES, PieceBatch, PostureSweep, Refinement, Refiner, SweepStats,
};
use touchoff_postures::{
    Accessibility, Directions, MapIdentity, MapRow, Piece, PostureMap, PostureRecord, Rules,
};

static SLIM: LazyLock<Interpreted> = LazyLock::new(|| {
    r#"tool Slim "a ball of 2 mm on a straight shank, 40 mm long" {
        units mm;
        profile {
            start (0, 0);
            arc to (1, 1) center (0, 1) as ball cutting;
            line to (1, 5) as flute cutting;
            line to (1, 40), (0, 40) as shank;
        }
        niceness cutting: 1 - depth;
    }"#
    .parse()
    .expect("a tool")
});

/// Returns a box of 60 by 40 by 20 with a pocket of 40 by 20 by 12, in 28 triangles.
fn pocket() -> Mesh {
    let corner = |[x, y]: [f64; 2], z: f64| Point3::new(x, y, z);
    let outer = [[0.0, 0.0], [60.0, 0.0], [60.0, 40.0], [0.0, 40.0]];
    let inner = [[10.0, 10.0], [50.0, 10.0], [50.0, 30.0], [10.0, 30.0]];
    let rings = [(outer, 0.0), (outer, 20.0), (inner, 20.0), (inner, 8.0)];
    let vertices = rings.iter().flat_map(|(ring, z)| ring.map(|at| corner(at, *z)));
    let mut triangles = vec![[0, 3, 2], [0, 2, 1], [12, 13, 14], [12, 14, 15]];
    for ring in 0..3 {
        for k in 0..4 {
            let [a, b] = [4 * ring + k, 4 * ring + (k + 1) % 4];
            triangles.extend([[a, b, b + 4], [a, b + 4, a + 4]]);
        }
    }
    Mesh::new(vertices, triangles, Unit::Millimetre).expect("a mesh")
}

/// Returns a mesh with each triangle divided into `side`² equal ones, those of a triangle one after another.
fn subdivided(mesh: &Mesh, side: u32) -> Mesh {
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for id in mesh.ids() {
        let [a, b, c] = mesh.triangle(id);
        let first = vertices.len() as u32;
        let mut index = HashMap::new();
        for i in 0..=side {
            for j in 0..=side - i {
                index.insert((i, j), first + index.len() as u32);
                let [u, v] = [i, j].map(|k| f64::from(k) / f64::from(side));
                vertices.push(a + (b - a) * u + (c - a) * v);
            }
        }
        for i in 0..side {
            for j in 0..side - i {
                let at = |i: u32, j: u32| index[&(i, j)];
                triangles.push([at(i, j), at(i + 1, j), at(i, j + 1)]);
                if i + j + 1 < side {
                    triangles.push([at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
                }
            }
        }
    }
    Mesh::new(vertices, triangles, mesh.unit()).expect("a mesh")
}

fn centre(corners: [Point3<f64>; 3]) -> Point3<f64> {
    let [a, b, c] = corners.map(|corner| corner.coords);
    ((a + b + c) / 3.0).into()
}

/// A part, and the rules of a sweep.
struct Case<'a> {
    mesh: &'a Mesh,
    bvh: TriangleBvh,
    directions: Directions,
    rules: Rules,
    tool: &'a dyn Tool,
}

impl<'a> Case<'a> {
    fn new(mesh: &'a Mesh, tool: &'a dyn Tool, directions: usize) -> Case<'a> {
        let rules = Rules { tolerance: 0.01, niceness: 0.0, allowed: Vec::new() };
        let (bvh, directions) = (TriangleBvh::new(mesh), Directions::spread(directions));
        Case { mesh, bvh, directions, rules, tool }
    }

    fn sweep(&self) -> PostureSweep<'_> {
        let (tools, rules) = (vec![self.tool], self.rules.clone());
        PostureSweep::new(self.mesh, &self.bvh, tools, &self.directions, rules, NonZeroU16::MIN)
            .expect("a sweep")
    }

    /// Returns the rows of all triangles.
    fn rows(&self) -> (Vec<MapRow>, SweepStats) {
        let (sweep, mut stats) = (self.sweep(), SweepStats::default());
        let mut rows = vec![MapRow::default(); self.mesh.triangles().len()];
        let all: Vec<usize> = (0..sweep.batches()).collect();
        let _: ControlFlow<()> = sweep.run(&all, |batch| {
            stats += batch.stats;
            batch.rows.into_iter().for_each(|(id, row)| rows[id.index()] = row);
            ControlFlow::Continue(())
        });
        (rows, stats)
    }

    /// Judges pieces until there are no more, in a map, and returns the counters.
    fn refine(&self, rows: &[MapRow], refinement: Refinement, map: &PostureMap) -> SweepStats {
        let sweep = self.sweep();
        let mut refiner = Refiner::new(self.mesh, 1, refinement).expect("lengths");
        let whole: Vec<(TriangleId, MapRow)> = self.mesh.ids().zip(rows.iter().cloned()).collect();
        map.record(&whole).expect("recorded");
        whole.iter().for_each(|(id, row)| refiner.add(Piece::whole(*id), row));
        let mut stats = SweepStats::default();
        loop {
            let pieces = refiner.next_pieces().expect("few pieces");
            let batches: Vec<usize> = (0..pieces.len().div_ceil(BATCH_TRIANGLES)).collect();
            if batches.is_empty() {
                return stats;
            }
            let _: ControlFlow<()> = sweep.run_pieces(&pieces, &batches, |batch: PieceBatch| {
                stats += batch.stats;
                map.record_pieces(&batch.rows).expect("recorded");
                batch.rows.iter().for_each(|(piece, row)| refiner.add(*piece, row));
                ControlFlow::Continue(())
            });
        }
    }

    fn map(&self, folder: &std::path::Path) -> PostureMap {
        let identity =
            MapIdentity::new(self.mesh, &[self.tool], self.rules.clone()).expect("rules");
        let identity = identity.with_directions(self.directions.list().to_vec());
        PostureMap::open(folder.join("a.postures"), &identity).expect("a map")
    }
}

fn is_reached(row: &MapRow) -> bool {
    row.access.iter().any(Accessibility::is_reached)
}

/// Fractions of the area that are coloured wrongly, beside a subdivided mesh: by centroids of triangles and by pieces.
/// `TOUCHOFF_PART` names another part, an STL file in mm, to measure it.
#[test]
fn pieces_colour_less_area_wrongly_than_centroids() {
    let part = std::env::var_os("TOUCHOFF_PART");
    let mesh = part.as_ref().map_or_else(pocket, |file| {
        Mesh::read_stl(file, Unit::Millimetre).expect("TOUCHOFF_PART is no STL file")
    });
    let (directions, side) = if part.is_some() { (200, 96) } else { (20, 48) };
    let side = side.min(((1 << 19) / mesh.triangles().len()).isqrt().max(1) as u32);
    let fine = subdivided(&mesh, side);
    let case = Case::new(&mesh, &*SLIM, directions);
    let folder = tempfile::tempdir().expect("a folder");
    let map = case.map(folder.path());
    let start = Instant::now();
    let (rows, stats) = case.rows();
    let by_centroids = start.elapsed();
    let refinement = Refinement::of_tools(&[&*SLIM], mesh.unit());
    assert_eq!(refinement, Refinement { longest: 2.0, finest: 0.25 });
    let refined = case.refine(&rows, refinement, &map);
    let by_pieces = start.elapsed();
    let start = Instant::now();
    let (dense, _) = Case::new(&fine, &*SLIM, directions).rows();
    let by_dense = start.elapsed();
    let (mut area, mut wrong, mut reached) = (0.0, [0.0; 2], [0.0; 3]);
    for id in mesh.ids() {
        let pieces: HashMap<Piece, MapRow> = map.pieces(id).expect("a map").into_iter().collect();
        let first = id.0 * side * side;
        for small in (first..first + side * side).map(TriangleId) {
            let point = centre(fine.triangle(small));
            let piece = Piece::find(|piece| pieces.contains_key(&piece), id, &mesh, point);
            let truth = is_reached(&dense[small.index()]);
            let own = fine.area(small);
            area += own;
            for (k, shown) in [is_reached(&rows[id.index()]), is_reached(&pieces[&piece]), truth]
                .into_iter()
                .enumerate()
            {
                reached[k] += if shown { own } else { 0.0 };
                if shown != truth {
                    wrong[k] += own;
                }
            }
        }
    }
    let [centroids, pieces] = wrong.map(|wrong| wrong / area);
    let coverage = map.coverage().expect("a map");
    println!(
        "{} triangles, {:.0} mm²: {} places by centroids in {by_centroids:.1?}; {} more for {} pieces, {by_pieces:.1?} in \
         all; {} in the subdivided mesh in {by_dense:.1?}",
        rows.len(),
        area,
        stats.triangles,
        refined.triangles,
        coverage.pieces,
        dense.len(),
    );
    let [by_centroid, by_piece, by_dense] = reached.map(|reached| 100.0 * reached / area);
    println!(
        "coloured wrongly: {:.2} % by centroids, {:.2} % by pieces; reached {by_centroid:.2} %, {by_piece:.2} %, in truth \
         {by_dense:.2} %",
        100.0 * centroids,
        100.0 * pieces
    );
    if part.is_none() {
        assert!(centroids > 0.03, "{centroids}");
        assert!(pieces < 0.1 * centroids, "{pieces} beside {centroids}");
    }
}

/// The postures of pieces are those of a sweep over the pieces as a mesh of their own, up to rounding of the normals.
#[test]
fn pieces_are_judged_like_triangles() {
    let mesh = pocket();
    let case = Case::new(&mesh, &*SLIM, 15);
    let folder = tempfile::tempdir().expect("a folder");
    let map = case.map(folder.path());
    let (rows, _) = case.rows();
    let refinement = Refinement { longest: 9.0, finest: 4.0 };
    case.refine(&rows, refinement, &map);
    let mut pieces = Vec::new();
    for id in mesh.ids() {
        pieces.extend(map.pieces(id).expect("a map"));
    }
    assert!(pieces.len() > 300, "{}", pieces.len());
    let corners: Vec<Point3<f64>> =
        pieces.iter().flat_map(|(piece, _)| piece.corners(&mesh)).collect();
    let triangles = (0..pieces.len() as u32).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]);
    let cut = Mesh::new(corners, triangles, mesh.unit()).expect("a mesh");
    let (alone, _) = Case::new(&cut, &*SLIM, 15).rows();
    let tip = |record: &PostureRecord| Point3::from(record.tip);
    let mut reached = 0;
    for ((piece, row), alone) in pieces.iter().zip(&alone) {
        let sets = [row, alone].map(|row| &row.access[0].directions);
        let differing: u32 = sets[0].iter().zip(sets[1]).map(|(a, b)| (a ^ b).count_ones()).sum();
        assert!(differing <= 1, "{piece:?}: {sets:?}");
        if let ([one], [other], 0) = (&*row.best, &*alone.best, differing) {
            assert!((tip(one) - tip(other)).norm() < 1e-9 || one.axis != other.axis, "{piece:?}");
            reached += 1;
        }
    }
    assert!(reached > 200, "{reached}");
    // The rows of the triangles are those of a sweep without refinement.
    for (id, row) in mesh.ids().zip(rows) {
        assert_eq!(map.row(id).expect("a map"), Some(row));
    }
}
