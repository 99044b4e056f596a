"""Files of other packages' formats, written by these: a test without the package is skipped."""

import json

import numpy as np
import pytest


def scan(numbers, ending="las", point_format=0, version="1.2", scales=None, offsets=None):
    """Whole numbers, (n, 3), in laspy's object, which write() makes a .las or .laz of."""
    laspy = pytest.importorskip("laspy")
    if ending == "laz":
        pytest.importorskip("lazrs")
    header = laspy.LasHeader(point_format=point_format, version=version)
    if scales is not None:
        header.scales, header.offsets = scales, offsets
    las = laspy.LasData(header)
    las.X, las.Y, las.Z = np.transpose(numbers)
    return las


def write_parquet(path, columns, geo=None):
    """Columns by name; `geo`: the metadata of GeoParquet."""
    pa = pytest.importorskip("pyarrow")
    parquet = pytest.importorskip("pyarrow.parquet")
    table = pa.table(columns)
    if geo:
        table = table.replace_schema_metadata({"geo": json.dumps(geo)})
    parquet.write_table(table, path, row_group_size=128)
    return path


def write_hdf5(path, datasets):
    h5py = pytest.importorskip("h5py")
    with h5py.File(path, "a") as file:
        for name, values in datasets.items():
            file[name] = values
