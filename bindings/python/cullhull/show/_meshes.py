"""Results as objects of trimesh, PyVista, Open3D and Shapely."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from .._errors import InvalidArgument
from .._extras import needed
from .._lists import Lists
from ._forms import Surface, Volume

_TETRAHEDRON, _POLYHEDRON = 10, 42  # as VTK numbers the types of cells


def raised(points: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Points of space: those of the plane get z = 0."""
    if points.shape[1] == 3:
        return points.copy()
    return np.column_stack([points, np.zeros(len(points))])


def to_trimesh(surface: Surface) -> Any:
    trimesh = needed("trimesh", "to_trimesh()", "mesh")
    return trimesh.Trimesh(
        raised(surface.points),
        surface.triangles,
        vertex_attributes={"point": np.array(surface.ids)},
        process=False,
    )


def to_open3d(surface: Surface) -> Any:
    open3d = needed("open3d", "to_open3d()", "open3d")
    mesh = open3d.geometry.TriangleMesh(
        open3d.utility.Vector3dVector(raised(surface.points)),
        open3d.utility.Vector3iVector(surface.triangles.astype(np.int32)),
    )
    mesh.compute_vertex_normals()
    return mesh


def tetrahedra_to_open3d(volume: Volume) -> Any:
    open3d = needed("open3d", "to_open3d()", "open3d")
    return open3d.geometry.TetraMesh(
        open3d.utility.Vector3dVector(volume.points.copy()),
        open3d.utility.Vector4iVector(volume.tetrahedra.astype(np.int32)),
    )


def _counted(polygons: Lists) -> npt.NDArray[np.int64]:
    """As VTK has lists: the length of each before its items."""
    offsets = np.asarray(polygons.offsets)
    return np.insert(np.asarray(polygons.items, dtype=np.int64), offsets[:-1], np.diff(offsets))


def to_pyvista(surface: Surface) -> Any:
    pyvista = needed("pyvista", "to_pyvista()", "mesh")
    data = pyvista.PolyData(raised(surface.points), _counted(surface.polygons))
    data.point_data["point"] = surface.ids
    for name, values in surface.data.items():
        data.cell_data[name] = values
    return data


def tetrahedra_to_pyvista(volume: Volume) -> Any:
    pyvista = needed("pyvista", "to_pyvista()", "mesh")
    count = len(volume.tetrahedra)
    rows = np.column_stack([np.full(count, 4, dtype=np.int64), volume.tetrahedra])
    grid = pyvista.UnstructuredGrid(
        rows.ravel(), np.full(count, _TETRAHEDRON, dtype=np.uint8), volume.points.copy()
    )
    grid.point_data["point"] = volume.ids
    for name, values in volume.data.items():
        grid.cell_data[name] = values
    return grid


def polyhedra_to_pyvista(
    points: npt.NDArray[np.float64],
    faces: list[list[npt.NDArray[np.int64]]],
    data: dict[str, npt.NDArray[Any]],
) -> Any:
    """A polyhedron for each list of faces, whose corners are places among the points."""
    pyvista = needed("pyvista", "to_pyvista()", "mesh")
    stream: list[int] = []
    for polygons in faces:
        cell = [len(polygons)]
        for polygon in polygons:
            cell += [len(polygon), *polygon.tolist()]
        stream += [len(cell), *cell]
    kinds = np.full(len(faces), _POLYHEDRON, dtype=np.uint8)
    grid = pyvista.UnstructuredGrid(np.array(stream, dtype=np.int64), kinds, points.copy())
    for name, values in data.items():
        grid.cell_data[name] = values
    return grid


def to_shapely(geometry: dict[str, Any]) -> Any:
    shapely = needed("shapely", "to_shapely()", "geo")
    return _shape(shapely, geometry)


def _shape(shapely: Any, geometry: dict[str, Any]) -> Any:
    kind = geometry["type"]
    if kind == "FeatureCollection":
        parts = [_shape(shapely, feature["geometry"]) for feature in geometry["features"]]
        return shapely.GeometryCollection(parts)
    if kind == "GeometryCollection":
        return shapely.GeometryCollection([_shape(shapely, g) for g in geometry["geometries"]])
    rows = geometry["coordinates"]
    if kind == "Polygon":
        return shapely.Polygon(rows[0], rows[1:]) if rows else shapely.Polygon()
    if kind == "MultiPolygon":
        return shapely.MultiPolygon([(rings[0], rings[1:]) for rings in rows])
    if kind in ("Point", "LineString", "MultiLineString"):
        return getattr(shapely, kind)(rows)
    raise InvalidArgument(f"no geometry of Shapely is a {kind}")
