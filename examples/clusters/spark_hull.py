"""Spark: the hull of a data frame's rows by states of its partitions, and a hull per group."""

import os
import sys

import numpy as np
import pyarrow as pa
from pyspark.sql import SparkSession, functions

import cullhull

os.environ.setdefault("PYSPARK_PYTHON", sys.executable)  # workers find what this process finds
spark = SparkSession.builder.master("local[2]").config("spark.ui.enabled", "false").getOrCreate()
spark.sparkContext.setLogLevel("ERROR")
table = spark.range(200_000, numPartitions=7).select(
    (functions.col("id") % 50).alias("customer"),
    functions.rand(1).alias("x"),
    (functions.rand(2) + functions.rand(3)).alias("y"),
)
names = ["x", "y"]


def states(batches):
    """A partition's rows become one state: a few kilobytes."""
    stream = cullhull.HullStream(threads=1)
    for batch in batches:
        stream.push(np.column_stack([batch[name].to_numpy() for name in names]))
    state = stream.state()
    if state.dimension:
        arrays = state.to_arrays()
        rows = [[bytes(arrays["points"].tobytes())], [int(state.point_count)]]
        yield pa.RecordBatch.from_arrays([pa.array(column) for column in rows], ["rows", "seen"])


# One hull: extreme points of the partitions, then of all.
parts = table.select(*names).mapInArrow(states, "rows binary, seen long").collect()
whole = cullhull.HullStream()
whole.extend(np.frombuffer(part["rows"]).reshape(-1, len(names)) for part in parts)
hull = whole.hull()
everything = table.select(*names).toPandas().to_numpy()
assert hull.volume == cullhull.convex_hull(everything).volume
print(f"{sum(part['seen'] for part in parts):,} rows: {len(hull.vertices)} vertices, "
      f"area {hull.volume:.6f}")


def area(group: pa.Table) -> pa.Table:
    points = np.column_stack([group[name].to_numpy() for name in names])
    return pa.table({"customer": group["customer"][:1],
                     "area": [cullhull.convex_hull(points).volume]})


# A hull per group.
areas = table.groupBy("customer").applyInArrow(area, "customer long, area double").toPandas()
rows = table.where("customer = 7").select(*names).toPandas().to_numpy()
assert areas.set_index("customer").loc[7, "area"] == cullhull.convex_hull(rows).volume
print(f"{len(areas)} groups; customer 7 has area {areas.set_index('customer').loc[7, 'area']:.6f}")
spark.stop()
