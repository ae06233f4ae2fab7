#!/usr/bin/env python3
# /// script
# requires-python = ">=3.10"
# dependencies = ["cadquery-ocp-novtk>=8.0", "numpy>=1.26", "scipy>=1.11"]
# ///
"""A weighted point cloud, and a mesh, of the faces of a STEP or IGES file. See docs/cad.md."""

import argparse
import gzip
import heapq
import sys
import tempfile
import time
import zlib
from pathlib import Path

try:
    import numpy as np
    from scipy.sparse import coo_array
    from scipy.spatial import cKDTree
    from OCP import BRep, BRepAdaptor, BRepGProp, BRepMesh, BRepTools, BRepTopAdaptor, GProp, IFSelect, IGESControl, Message
    from OCP import STEPControl, ShapeAnalysis, TopAbs, TopExp, TopLoc, TopoDS, gp
except ImportError as missing:
    sys.exit(f"{missing}; pip install cadquery-ocp-novtk numpy scipy")

PER_POINT = 80  # places that share out the area, for each point
STRIDE = 10  # one in so many may become a point
PRECISION = 1e-10  # relative, of each face's area and of the volume
CLOUD = [(name, "<f8") for name in ("x", "y", "z", "nx", "ny", "nz", "area")] + [("face", "<u4")]
MESH = [("vertex_indices", "u1"), ("three", "<i4", 3), ("face", "<u4")]
UNITS = {"mm": 1.0, "inch": 25.4, "m": 1000.0}


class Refusal(Exception):
    """What the file does not allow, as a sentence."""


def read(path):
    """The shape, in mm."""
    data = Path(path).read_bytes()
    data = gzip.decompress(data) if data[:2] == b"\x1f\x8b" else data
    if data.lstrip().startswith(b"ISO-10303-21"):
        reader = STEPControl.STEPControl_Reader()
    elif data.split(b"\n", 1)[0][72:73] in (b"S", b"C"):
        reader = IGESControl.IGESControl_Reader()
    else:
        raise Refusal(f"{path} is neither STEP nor IGES")
    Message.Message.DefaultMessenger_s().ChangePrinters().Clear()
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder, "part")
        copy.write_bytes(data)
        if reader.ReadFile(str(copy)) != IFSelect.IFSelect_RetDone or reader.TransferRoots() == 0 or reader.OneShape().IsNull():
            raise Refusal(f"{path} holds no shape that can be read")
    return reader.OneShape()


def explore(shape, kind, avoid=TopAbs.TopAbs_SHAPE):
    explorer = TopExp.TopExp_Explorer(shape, kind, avoid)
    while explorer.More():
        yield explorer.Current()
        explorer.Next()


def length(x):
    return np.linalg.norm(x, axis=-1)


def regular(normal, su, sv):
    """Not at a pole, where there is no normal."""
    size = length(normal)
    return size > np.maximum(1e-7 * length(su) * length(sv), 1e-9 * size.max(initial=0.0))


class Face:
    def __init__(self, face, solid, index):
        self.id, self.face, self.solid = index, TopoDS.TopoDS.Face(face), solid
        self.surface = BRepAdaptor.BRepAdaptor_Surface(self.face, False)
        mirrored = self.face.Location().Transformation().IsNegative()
        self.sign = -1.0 if (self.face.Orientation() == TopAbs.TopAbs_REVERSED) != mirrored else 1.0
        BRepGProp.BRepGProp.SurfaceProperties_s(self.face, mass := GProp.GProp_GProps(), PRECISION, False)
        self.area = abs(mass.Mass())

    def at(self, uv):
        """Places on the surface, its outward normals there, of length |Su x Sv|, and Su and Sv."""
        out = np.empty((len(uv), 9))
        p, su, sv, d1 = gp.gp_Pnt(), gp.gp_Vec(), gp.gp_Vec(), self.surface.D1
        for row, (u, v) in zip(out, uv.tolist()):
            d1(u, v, p, su, sv)
            row[:] = p.X(), p.Y(), p.Z(), su.X(), su.Y(), su.Z(), sv.X(), sv.Y(), sv.Z()
        return out[:, :3], np.cross(out[:, 3:6], out[:, 6:]) * self.sign, out[:, 3:6], out[:, 6:]

    def triangles(self):
        """Nodes, their (u, v), and triangles, turned outward."""
        location = TopLoc.TopLoc_Location()
        mesh = BRep.BRep_Tool.Triangulation_s(self.face, location)
        if mesh is None or not mesh.HasUVNodes() or mesh.NbTriangles() == 0:
            raise Refusal(f"face {self.id} cannot be triangulated")
        move, count = location.Transformation(), range(1, mesh.NbNodes() + 1)
        nodes = np.array([(p.X(), p.Y(), p.Z()) for p in (mesh.Node(i).Transformed(move) for i in count)])
        uv = np.array([(p.X(), p.Y()) for p in (mesh.UVNode(i) for i in count)])
        corners = np.array([mesh.Triangle(i).Get() for i in range(1, mesh.NbTriangles() + 1)]) - 1
        return nodes, uv, corners if self.sign > 0 else corners[:, ::-1]

    def foot(self, places, uv):
        """Distances of places from the surface, and the normals at their feet."""
        surface, out = ShapeAnalysis.ShapeAnalysis_Surface(BRep.BRep_Tool.Surface_s(self.face)), np.empty((len(uv), 3))
        for row, place, (u, v) in zip(out, places.tolist(), uv.tolist()):
            foot = surface.NextValueOfUV(gp.gp_Pnt2d(u, v), gp.gp_Pnt(*place), 1e-9)
            row[:] = foot.X(), foot.Y(), surface.Gap()
        _, normal, su, sv = self.at(out[:, :2])
        return out[:, 2], normal * regular(normal, su, sv)[:, None]


def triangulate(shape, deflection, angle):
    BRepTools.BRepTools.Clean_s(shape)
    BRepMesh.BRepMesh_IncrementalMesh(shape, deflection, False, angle, False)


def volume(corners):
    return (corners[:, 0] * np.cross(corners[:, 1], corners[:, 2])).sum() / 6.0


def candidates(face, size, count, rng):
    """Places on the face, evenly by area, and the area of each."""
    nodes, uv, corners = face.triangles()
    tri, places = uv[corners], nodes[corners]
    for _ in range(40):  # enough to halve any face
        edges = length(places - np.roll(places, -1, axis=1))
        if not (split := edges.max(axis=1) > size).any():
            break
        turn = (edges.argmax(axis=1)[:, None] + np.arange(3)) % 3  # the longest edge first
        tri, places = (np.take_along_axis(x, turn[:, :, None], axis=1) for x in (tri, places))
        middle = tri[split, :2].mean(axis=1)
        halves = [(x, x[split, 0], m, x[split, 1], x[split, 2]) for x, m in ((tri, middle), (places, face.at(middle)[0]))]
        tri, places = (np.concatenate([x[~split], np.stack([a, m, c], 1), np.stack([m, b, c], 1)]) for x, a, m, b, c in halves)
    cell = np.abs(np.linalg.det(tri[:, 1:] - tri[:, :1])) / 2.0
    share = cell * length(face.at(tri.mean(axis=1))[1])
    total = share.cumsum()
    chosen = np.searchsorted(total[:-1], (np.arange(count) + rng.random(count)) * (total[-1] / count), side="right")
    root, along = np.sqrt(rng.random(count)), rng.random(count)
    at = np.einsum("ij,jik->jk", [1.0 - root, root * (1.0 - along), root * along], tri[chosen])
    places, normals, su, sv = face.at(at)
    size = length(normals)
    area = size * cell[chosen] / share[chosen] * (total[-1] / count)
    return at, places, normals / np.where(size > 0, size, 1)[:, None], area, regular(normals, su, sv), total[-1]


def thin(places, normals, ids, wanted, area):
    """Weighted sample elimination (Yuksel 2015): the most crowded goes first. Both sides of a thin wall do not see each other."""
    reach = 2.0 * np.sqrt(area / (2.0 * np.sqrt(3.0) * wanted))
    pairs = cKDTree(places).query_pairs(reach, output_type="ndarray")
    i, j = pairs[(ids[pairs[:, 0]] == ids[pairs[:, 1]]) | ((normals[pairs[:, 0]] * normals[pairs[:, 1]]).sum(axis=1) > -0.5)].T
    crowd = coo_array(((1.0 - length(places[i] - places[j]) / reach) ** 8, (i, j)), shape=(len(places), len(places))).tocsr()
    crowd = (crowd + crowd.T).tocsr()
    begin, end, crowd, weight = crowd.indptr.tolist(), crowd.indices, crowd.data, crowd.sum(axis=1)
    heapq.heapify(heap := [(-w, i) for i, w in enumerate(weight.tolist())])
    kept, keep, left, face = len(places), np.ones(len(places), dtype=bool), np.bincount(ids).tolist(), ids.tolist()
    while kept > wanted and heap:
        stored, i = heapq.heappop(heap)
        now = -float(weight[i])
        if now > stored:  # it has lost neighbours since
            heapq.heappush(heap, (now, i))
        elif left[face[i]] > 1:
            kept, keep[i], left[face[i]] = kept - 1, False, left[face[i]] - 1
            weight[end[begin[i] : begin[i + 1]]] -= crowd[begin[i] : begin[i + 1]]
    return keep


def sample(faces, shape, wanted, seed):
    total, wanted = sum(face.area for face in faces), max(wanted, len(faces))
    spacing = np.sqrt(total / wanted)
    triangulate(shape, spacing / 100.0, 0.1)
    rng, parts, cover = np.random.default_rng(seed), [], 0.0
    for face in faces:
        count = max(30 * STRIDE, round(PER_POINT * wanted * face.area / total))
        uv, places, normals, area, fine, found = candidates(face, 0.7 * min(spacing, np.sqrt(face.area) / 5.0), count, rng)
        cover = max(cover, abs(found / face.area - 1.0))
        some = np.flatnonzero(fine & (np.arange(count) % STRIDE == 0))
        tool = BRepTopAdaptor.BRepTopAdaptor_TopolTool(BRepAdaptor.BRepAdaptor_Surface(face.face))
        some = np.array([i for i in some if tool.Classify(gp.gp_Pnt2d(*uv[i].tolist()), 1e-9) != TopAbs.TopAbs_OUT], dtype=int)
        if len(some) == 0:
            raise Refusal(f"no point of face {face.id} has a normal")
        parts.append((places, area * (face.area / area.sum()), some, normals[some], np.full(len(some), face.id)))
    keep = thin(*(np.concatenate(x) for x in zip(*((p[0][p[2]], p[3], p[4]) for p in parts))), wanted, total)
    out, keep = [], np.split(keep, np.cumsum([len(p[2]) for p in parts])[:-1])
    for (places, area, some, normals, ids), mine in zip(parts, keep):
        points = places[some[mine]]
        cells = np.bincount(cKDTree(points).query(places)[1], area, len(points))
        out.append(np.column_stack([points, normals[mine], cells, ids[mine]]))
    return np.concatenate(out), cover


def tessellate(faces, shape, deflection, angle):
    """Vertices, triangles, their faces, greatest distances from the surface, areas, and greatest angles to its normal."""
    triangulate(shape, deflection, angle)
    parts, base, grid = [], 0, np.array([(i, j, 4 - i - j) for i in range(5) for j in range(5 - i)]) / 4.0
    for face in faces:
        own, uv, triangles = face.triangles()
        flat = np.cross(own[triangles[:, 1]] - own[triangles[:, 0]], own[triangles[:, 2]] - own[triangles[:, 0]])
        places, at = (np.einsum("gc,tck->tgk", grid, x[triangles]).reshape(-1, x.shape[1]) for x in (own, uv))
        distance, normal = face.foot(places, at)
        normal, flat = normal.reshape(len(triangles), -1, 3), flat[:, None]
        turn = np.arctan2(length(np.cross(flat, normal)), (flat * normal).sum(axis=2)).max(axis=1)
        off = distance.reshape(len(triangles), -1).max(axis=1)
        parts.append((own, triangles + base, np.full(len(triangles), face.id), off, length(flat)[:, 0] / 2.0, np.degrees(turn)))
        base += len(own)
    nodes, corners, *rest = (np.concatenate(x) for x in zip(*parts))
    nodes, same = np.unique(nodes + 0.0, axis=0, return_inverse=True)
    real = ((corners := same.reshape(-1)[corners]) != np.roll(corners, 1, axis=1)).all(axis=1)
    return nodes, corners[real], *(x[real] for x in rest)


def write(path, comments, elements):
    kinds = {"<f8": "double", "<u4": "uint", "|u1": "list uchar int"}
    lines = ["ply", "format binary_little_endian 1.0", *(f"comment {comment}" for comment in comments)]
    for name, rows in elements:
        kept = [field for field in rows.dtype.names if field != "three"]
        lines += [f"element {name} {len(rows)}", *(f"property {kinds[rows.dtype[field].str]} {field}" for field in kept)]
    Path(path).write_bytes("\n".join([*lines, "end_header", ""]).encode() + b"".join(rows.tobytes() for _, rows in elements))


def load(path, flip):
    """The shape, its faces in the file's order, and the volume of each solid."""
    shape = read(path)
    solids = list(explore(shape, TopAbs.TopAbs_SOLID))
    found = [(face, k) for k, solid in enumerate(solids) for face in explore(solid, TopAbs.TopAbs_FACE)]
    found += [(face, None) for face in explore(shape, TopAbs.TopAbs_FACE, TopAbs.TopAbs_SOLID)]
    faces = [face for face in (Face(*pair, index) for index, pair in enumerate(found)) if face.area > 0.0]
    if not faces:
        raise Refusal(f"{path} holds no faces")
    total = 0.0
    for solid in solids:
        BRepGProp.BRepGProp.VolumeProperties_s(solid, mass := GProp.GProp_GProps(), PRECISION, False, False)
        total += abs(mass.Mass())
    triangulate(shape, np.sqrt(sum(face.area for face in faces)) / 1000.0, 0.3)
    for k in [*range(len(solids)), None]:
        mine = [face for face in faces if face.solid == k]
        sides = (nodes[corners] for nodes, _, corners in (face.triangles() for face in mine))
        if flip if k is None else sum(map(volume, sides)) < 0.0:
            print("the faces of no solid are turned" if k is None else f"solid {k} is inside out: its faces are turned")
            for face in mine:
                face.sign = -face.sign
    return shape, faces, total


def convert(given):
    began = time.time()
    shape, faces, solid = load(given.input, given.flip)
    loose, unit = [face for face in faces if face.solid is None], UNITS[given.unit]
    area, closed = sum(face.area for face in faces), not loose
    print(f"{len(faces)} faces, {len(loose)} of no solid; area {area:.12g} mm2" + f", volume {solid:.12g} mm3" * closed)
    head = [f"{Path(given.input).name}, in {given.unit}", f"area {area / unit**2:.17g}, {len(faces)} faces"]
    if given.out:
        rows, cover = sample(faces, shape, given.points, given.seed)
        places, normals, cells = rows[:, :3], rows[:, 3:6], rows[:, 6]
        near = cKDTree(places).query(places, 2)[0][:, 1] if len(rows) > 1 else np.zeros(1)
        print(f"{len(rows)} points, {np.median(near):.4g} mm apart (median), seconds: {time.time() - began:.1f}")
        print(f"  area: off by {cells.sum() / area - 1.0:.1e}; that of a face before it was made exact, by {cover:.1e}")
        around = (cells[:, None] * normals * (places - places.mean(axis=0))).sum() / 3.0
        print(f"  volume by the points: off by {around / (solid or 1.0) - 1.0:.1e}\n" * closed, end="")
        rows /= [unit, unit, unit, 1, 1, 1, unit**2, 1]
        write(given.out, head, [("vertex", np.rec.fromarrays(rows.T, dtype=CLOUD))])
    if given.mesh:
        nodes, corners, ids, off, flats, turns = tessellate(faces, shape, given.deflection, np.radians(given.angle))
        most = turns[(rank := turns.argsort())[np.searchsorted(flats[rank].cumsum(), 0.99 * flats.sum())]]
        ways = np.sort(np.concatenate([corners[:, [0, 1]], corners[:, [1, 2]], corners[:, [2, 0]]]), axis=1)
        once = (np.unique(ways, axis=0, return_counts=True)[1] != 2).sum()
        print(f"{len(corners)} triangles, {len(nodes)} vertices, {once} edges not of two; seconds in all: {time.time() - began:.1f}")
        print(f"  at most {off.max():.4g} mm off the surface, {turns.max():.4g} degrees off its normal ({most:.3g} on 99% of the area)")
        print(f"  volume: off by {volume(nodes[corners]) / (solid or 1.0) - 1.0:.1e}\n" * closed, end="")
        vertex = np.rec.fromarrays((nodes / unit).T, dtype=CLOUD[:3])
        rows = np.rec.fromarrays([np.full(len(ids), 3), corners, ids], dtype=MESH)
        write(given.mesh, head, [("vertex", vertex), ("face", rows)])


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("input", help="STEP or IGES file, also gzipped")
    parser.add_argument("-o", "--out", help="output file for the points, in PLY; give -o, --mesh or both")
    parser.add_argument("--points", type=int, default=20000, help="number of points, at least one per face [default: %(default)s]")
    parser.add_argument("--mesh", help="output file for the triangles, in PLY")
    distance = "target distance of triangles from the surface, always in mm [default: %(default)s]"
    parser.add_argument("--deflection", type=float, default=0.05, help=distance)
    parser.add_argument("--angle", type=float, default=20.0, help="target angle between neighbouring triangles, in degrees [default: %(default)s]")
    parser.add_argument("--unit", choices=UNITS, default="mm", help="unit of the written coordinates; messages are in mm [default: %(default)s]")
    parser.add_argument("--flip", action="store_true", help="reverse the orientation of faces that belong to no solid")
    seed = "seed of the sampling; the same seed gives the same file [default: %(default)s]"
    parser.add_argument("--seed", type=int, default=1, help=seed)
    given = parser.parse_args()
    if not (given.out or given.mesh) or given.points < 1 or not given.deflection > 0 or not given.angle > 0:
        parser.error("give -o, --mesh or both; points, deflection and angle are above 0")
    try:
        convert(given)
    except Refusal as refusal:
        sys.exit(f"error: {refusal}")
    except (OSError, EOFError, zlib.error) as error:
        why = getattr(error, "strerror", None) or error
        sys.exit(f"error: {getattr(error, 'filename', None) or given.input}: {why}")


if __name__ == "__main__":
    main()
