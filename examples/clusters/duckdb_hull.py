"""DuckDB: the hull of a query's rows, which never lie in memory at once, and a hull per group."""

import duckdb
import numpy as np

import cullhull

database = duckdb.connect()
database.execute("SELECT setseed(0.5)")
database.execute(
    """CREATE TABLE trips AS
       SELECT range % 1000 AS customer, random() AS x, random() + random() AS y
       FROM range(200_000)"""
)


def blocks(query, rows=50_000):
    """Arrow batches as arrays of x, y."""
    for batch in database.sql(query).to_arrow_reader(rows):
        yield np.column_stack([column.to_numpy() for column in batch.columns])


# One hull: the rows of the query go through a stream.
stream = cullhull.HullStream()
stream.extend(blocks("SELECT x, y FROM trips"))
hull = stream.hull()
rows = database.execute("SELECT x, y FROM trips").fetchnumpy()
assert hull.volume == cullhull.convex_hull(np.column_stack([rows["x"], rows["y"]])).volume
print(f"{stream.point_count:,} rows: {len(hull.vertices)} vertices, area {hull.volume:.6f}")

# A hull per group: rows ordered by group, one call for all of them.
rows = database.execute("SELECT customer, x, y FROM trips ORDER BY customer").fetchnumpy()
points = np.column_stack([rows["x"], rows["y"]])
customers, first = np.unique(rows["customer"], return_index=True)
batch = cullhull.convex_hulls(points, np.append(first, len(points)))
areas = {int(c): float(v) for c, v in zip(customers, batch.volumes)}
one = points[rows["customer"] == 7]
assert areas[7] == cullhull.convex_hull(one).volume
print(f"{len(areas):,} groups; customer 7 has area {areas[7]:.6f}")
