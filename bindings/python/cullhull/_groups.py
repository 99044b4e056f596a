"""A hull for each group of points: those with the same key."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from ._answers import Mesh
from ._arguments import as_points, refuse_mask
from ._batches import HullBatch, convex_hulls
from ._compared import Compared
from ._errors import InvalidArgument
from ._hull import Hull
from ._options import Budgeted, Unpack, documented, require_known, takes
from .show._forms import Surface, Table
from .show._shown import Exported


class GroupHulls(Exported, Compared, Mapping[Any, Hull]):
    """The hulls of groups, from `hulls_by`: a mapping from key to `Hull`, ordered by key.

    Arrays over all groups are in `batch`, in the order of `keys`; which points a group has is in
    `members`. Vertex indices of a group's hull count its own points: ``members(key)[hull.vertices]``
    are the rows of all points. Two of them are equal where keys, members and hulls are.

    Raises
    ------
    TypeError
        When called: they are made by `hulls_by`.
    KeyError
        For a key that no point has.

    Examples
    --------
    >>> import cullhull, numpy as np
    >>> points = np.array([[0, 0], [9, 9], [1, 0], [0, 1], [8, 9]])
    >>> hulls = cullhull.hulls_by(points, ["a", "b", "a", "a", "b"])
    >>> hulls
    <GroupHulls of 2 groups in 2D>
    >>> [str(key) for key in hulls], hulls["a"].volume, hulls.batch.point_counts
    (['a', 'b'], 0.5, array([3, 2]))
    >>> hulls.members("b")
    array([1, 4])
    """

    __slots__ = ("_keys", "_order", "_starts", "_places", "batch")

    _keys: npt.NDArray[Any]
    _order: npt.NDArray[np.int64]
    _starts: npt.NDArray[np.int64]
    _places: dict[Any, int] | None
    batch: HullBatch

    def __init__(self) -> None:
        raise TypeError("hulls of groups are made by cullhull.hulls_by")

    @classmethod
    def _of(cls, keys: Any, order: Any, starts: Any, batch: HullBatch) -> GroupHulls:
        result = object.__new__(cls)
        result._keys, result._order, result._starts = keys, order, starts
        result._places = None
        result.batch = batch
        return result

    def __reduce__(self) -> tuple[Any, ...]:
        return GroupHulls._of, (self._keys, self._order, self._starts, self.batch)

    def _place(self, key: Any) -> int:
        if self._places is None:
            self._places = {k: i for i, k in enumerate(self._keys.tolist())}
        try:
            return self._places[key.item() if isinstance(key, np.generic) else key]
        except TypeError:  # not hashable
            raise KeyError(key) from None

    def __getitem__(self, key: Any) -> Hull:
        return self.batch[self._place(key)]

    def __iter__(self) -> Iterator[Any]:
        return iter(self._keys.tolist())

    def __len__(self) -> int:
        return len(self._keys)

    @property
    def group_keys(self) -> npt.NDArray[Any]:
        """(g,) array of the keys, ascending: group i of `batch` has ``group_keys[i]``."""
        return self._keys

    __hash__ = None  # type: ignore[assignment]

    def _parts(self) -> tuple[Any, ...]:
        return self._keys, self._order, self._starts, self.batch

    def mesh(self) -> Mesh:
        """The boundaries of all hulls as one mesh: as `HullBatch.mesh` of `batch`.

        Returns
        -------
        Mesh

        Raises
        ------
        InvalidArgument (a ValueError)
            For hulls of different affine dimensions.

        Examples
        --------
        >>> import cullhull
        >>> points = [[0, 0], [4, 0], [0, 4], [9, 9], [8, 9], [9, 8]]
        >>> cullhull.hulls_by(points, list("aaabbb")).mesh().faces.shape
        (6, 2)
        """
        return self.batch.mesh()

    def _surface(self) -> Surface:
        surface = self.batch._surface()
        return surface._replace(ids=self._order[surface.ids + self._row_starts()])

    def _row_starts(self) -> npt.NDArray[np.int64]:
        """The first row of its group's points, for each vertex of the batch."""
        return np.repeat(self._starts[:-1], self.batch.vertices.lengths())

    def _geometry(self) -> dict[str, Any]:
        found = self.batch._geometry()
        for key, feature in zip(self, found["features"]):
            properties = feature["properties"]
            del properties["set"]
            feature["properties"] = {"key": key, **properties}
        return found

    def _in_place(self) -> HullBatch:
        return self.batch

    def _table(self) -> Table:
        rows = [("groups", f"{len(self):,}"), *self.batch._table().rows[1:]]
        return Table("Convex hulls of groups", rows)

    @documented("path", "format", "crs")
    def save(
        self,
        path: str | os.PathLike[str],
        *,
        format: str = "",
        by: str = "key",
        crs: str | None = None,
    ) -> None:
        """Writes the hulls to a file, a record for each group, as ``cullhull hull --by`` does.

        .csv and .json hold hulls of any dimension, .geojson .gpkg .fgb .shp those of 2D points: docs/formats.md, "A
        hull for each group", describes them. Keys are written as text. If all are numbers they are
        written as numbers, in ascending order; otherwise the groups are in the order of the text.
        An error leaves no part of a file behind.

        Parameters
        ----------
        by : str
            The name of the keys in the file.

        Raises
        ------
        FileError (an OSError)
            If the operating system refuses to write the file.
        InvalidArgument (a ValueError)
            If the format is unknown, or cannot hold the hulls.

        Examples
        --------
        >>> import cullhull, os, tempfile
        >>> hulls = cullhull.hulls_by([[0, 0], [9, 9], [1, 0], [0, 1]], ["a", "b", "a", "a"])
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     hulls.save(os.path.join(folder, "hulls.csv"), by="town")
        ...     print(open(os.path.join(folder, "hulls.csv")).read().strip())
        town,points,vertices,perimeter,area,wkt
        a,3,3,3.414213562373095,0.5,"POLYGON ((0 0, 1 0, 0 1, 0 0))"
        b,1,1,0,0,"POINT (9 9)"
        """
        keys = _texts(self._keys)
        from .geo._maps import save_map  # with what writes files

        save_map(path, format, crs, lambda *to: self.batch._write_by(keys, by, *to))

    def members(self, key: Any) -> npt.NDArray[np.int64]:
        """Indices of the points that have this key, ascending.

        Parameters
        ----------
        key : as in `hulls_by`

        Returns
        -------
        (m,) int64 array

        Raises
        ------
        KeyError
            For a key that no point has.

        Examples
        --------
        >>> import cullhull
        >>> cullhull.hulls_by([[0, 0], [5, 5], [1, 1]], [7, 8, 7]).members(7)
        array([0, 2])
        """
        i = self._place(key)
        return self._order[self._starts[i] : self._starts[i + 1]]

    def __repr__(self) -> str:
        return f"<GroupHulls of {len(self)} groups in {self.batch.dimension}D>"


def _texts(keys: npt.NDArray[Any]) -> list[str]:
    """Keys as they are written: whole numbers without a decimal point."""
    if keys.dtype.kind in "mM":
        return [str(key) for key in keys]  # tolist() gives integers for nanoseconds
    return list(map(_text, keys.tolist()))


def _text(key: Any) -> str:
    if isinstance(key, float) and key.is_integer() and abs(key) < 1e16:
        return str(int(key))
    return key.decode(errors="replace") if isinstance(key, bytes) else str(key)


def _is_missing(key: Any) -> bool:
    if key is None:
        return True
    try:
        return bool(key != key)  # NaN, NaT
    except TypeError:  # pandas.NA has no truth
        return True


def _as_they_are(keys: Any) -> npt.NDArray[Any]:
    """An array of the keys; of objects where NumPy's common type would make unlike keys alike.

    1 and "1" become words, 2**53 + 1 beside 0.5 is rounded, "a\\0" loses its end.
    """
    array = np.asarray(keys)
    if isinstance(keys, np.ndarray) or array.ndim != 1 or array.dtype.kind == "O":
        return array
    listed = list(keys)
    if all(a == b for a, b in zip(array.tolist(), listed)):
        return array
    objects = np.empty(len(listed), dtype=object)
    objects[:] = listed
    return objects


def _codes(keys: Any) -> tuple[npt.NDArray[Any], npt.NDArray[Any]]:
    """The distinct keys, ascending, and each point's index into them."""
    refuse_mask(keys, "keys")
    if hasattr(keys, "combine_chunks"):  # an Arrow column, maybe in chunks
        keys = keys.combine_chunks()
    if hasattr(keys, "null_count"):  # a number in Arrow, a method in polars
        nulls = keys.null_count() if callable(keys.null_count) else keys.null_count
        if nulls:
            raise InvalidArgument(f"`keys` has {nulls} missing values")
    if hasattr(keys, "to_numpy"):
        try:
            array = keys.to_numpy(zero_copy_only=False)  # Arrow
        except TypeError:
            array = keys.to_numpy()  # pandas, polars
    else:
        array = _as_they_are(keys)
    array = np.asarray(array)
    if array.ndim != 1:
        raise InvalidArgument(f"`keys` should be one value a point, not of shape {array.shape}")
    if array.dtype.kind in "fc" and np.isnan(array).any():
        raise InvalidArgument(f"`keys` has {int(np.isnan(array).sum())} missing values (NaN)")
    if array.dtype.kind in "mM" and np.isnat(array).any():
        raise InvalidArgument(f"`keys` has {int(np.isnat(array).sum())} missing values (NaT)")
    if array.dtype.kind == "O" and any(map(_is_missing, array)):
        raise InvalidArgument("`keys` has missing values")
    try:
        names, inverse = np.unique(array, return_inverse=True)
    except TypeError:
        raise InvalidArgument("`keys` should be of one kind, so that they have an order") from None
    return names, inverse


def _split_column(points: Any, keys: Any) -> tuple[Any, Any]:
    """The other columns of a table, and the one that ``keys`` names."""
    columns = getattr(points, "columns", None)
    if not isinstance(keys, str) or columns is None:
        return points, keys
    # pandas and polars have names there, a table of Arrow has columns, and its names elsewhere.
    names = list(getattr(points, "column_names", columns))
    if keys not in names:
        listed = ", ".join(map(repr, names))
        raise InvalidArgument(f"there is no column {keys!r}; the table has {listed}")
    found = points[keys]
    if getattr(found, "ndim", 1) != 1:
        raise InvalidArgument(f"the table has several columns {keys!r}")
    geometry = getattr(points, "_geometry_column_name", None)
    if geometry in names and keys != geometry:  # of GeoPandas
        return points[geometry], found
    if hasattr(points, "drop_columns"):  # Arrow
        return points.drop_columns([keys]), found
    rest = points.drop(columns=[keys]) if hasattr(points, "iloc") else points.drop(keys)
    return rest, found


@takes(Budgeted)
def hulls_by(points: Any, keys: Any, **options: Unpack[Budgeted]) -> GroupHulls:
    """The exact hull of each group of points, in one call over all cores.

    Parameters
    ----------
    points : (n, d) array
        In any order: they are sorted by key.
    keys : n numbers, words or other values with an order, or str
        A list, NumPy array, pandas or polars Series (categories, too), or Arrow array. Of a data
        frame or a table of pandas, GeoPandas, polars or Arrow the name of a column: the other
        columns are the coordinates.

    Returns
    -------
    GroupHulls

    Raises
    ------
    InvalidArgument, NotFinite (ValueErrors), TypeError, OutOfBudget (a MemoryError)
        As `convex_hulls`; and for keys that are missing or have no order, and for a column that the
        table does not have.

    Examples
    --------
    >>> import cullhull
    >>> points = cullhull.generate("cube", 1000, 2)
    >>> hulls = cullhull.hulls_by(points, points[:, 0] > points[:, 1])
    >>> len(hulls), sum(hull.point_count for hull in hulls.values())
    (2, 1000)
    """
    require_known(options, Budgeted)
    points, keys = _split_column(points, keys)
    array = as_points(points)
    names, inverse = _codes(keys)
    if len(inverse) != len(array):
        raise InvalidArgument(f"{len(array)} points, but {len(inverse)} keys")
    # Stable, so that a group's points keep their order, as convex_hull would have them.
    order = np.argsort(inverse, kind="stable").astype(np.int64, copy=False)
    starts = np.zeros(len(names) + 1, dtype=np.int64)
    np.cumsum(np.bincount(inverse, minlength=len(names)), out=starts[1:])
    batch = convex_hulls(array[order], starts, **options)
    return GroupHulls._of(names, order, starts, batch)
