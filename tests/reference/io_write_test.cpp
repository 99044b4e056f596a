// Meshes and Qhull's text.
#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

#include "cullhull/generate.hpp"
#include "io/json/json.hpp"
#include "io/write/mesh.hpp"
#include "tests/hull_fixtures.hpp"
#include "tests/io_fixtures.hpp"
#include "thrown.hpp"

namespace cullhull::testing::io_write_test {

std::string written(const Example& e, const std::string& name, const std::string& format = "",
                    Faces faces = Faces::by_format) {
  const TemporaryFolder folder;
  write_hull(folder.file(name), e.view(), e.hull, format, faces);
  EXPECT_EQ(folder.entries(), 1U);
  return slurp(folder.file(name));
}

Rows corners() {
  Rows rows;
  for (int i = 0; i < 8; ++i)
    rows.push_back({static_cast<double>(i & 1), static_cast<double>((i >> 1) & 1),
                    static_cast<double>(i >> 2)});
  return rows;
}

TEST(Mesh, OffAndObjHoldTheHullsVerticesOnly) {
  const auto polygons = [](const Example& e, const char* name) {
    return written(e, name, "", Faces::polygons);
  };
  EXPECT_EQ(polygons(cube(), "a.off"),
            "OFF\n8 6 12\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 0 1\n1 0 1\n0 1 1\n1 1 1\n"
            "4 0 1 5 4\n4 0 2 3 1\n4 0 4 6 2\n4 1 3 7 5\n4 2 6 7 3\n4 4 5 7 6\n");
  EXPECT_EQ(polygons(cube(), "a.obj"),
            "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 0 0 1\nv 1 0 1\nv 0 1 1\nv 1 1 1\n"
            "f 1 2 6 5\nf 1 3 4 2\nf 1 5 7 3\nf 2 4 8 6\nf 3 7 8 4\nf 5 6 8 7\n");
  EXPECT_EQ(polygons(square(), "a.off"), "OFF\n4 1 4\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n");
  EXPECT_EQ(written(square(), "a.off"),
            "OFF\n4 2 5\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n");
  EXPECT_EQ(written(square(), "a.obj"), "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n");
}

// Lists of several rounds of pieces that threads format, each with its own rest: in order, no row
// twice, none left out, and of JSON the bytes that one thread writes.
TEST(Mesh, LongListsAreWrittenInOrder) {
  const TemporaryFolder folder;
  const std::vector<double> rows = generate("sphere", 70000, 3, 1);
  const PointView view = PointView::row_major(rows.data(), 70000, 3);
  const Hull hull = convex_hull(view);
  std::string json, obj, off;
  internal::write_result_json(view, hull, [&](const std::string& piece) { json += piece; });
  std::ostringstream count;
  count << "OFF\n"
        << hull.vertices.size() << ' ' << hull.simplex_count() << ' '
        << hull.simplex_count() * 3 / 2 << '\n';
  off = count.str();
  for (const std::uint64_t v : hull.vertices) {
    obj += 'v';
    for (unsigned j = 0; j < 3; ++j) {
      obj += ' ';
      internal::append_number(obj, view.at(v, j));
      internal::append_number(off, view.at(v, j));
      off += j < 2 ? ' ' : '\n';
    }
    obj += '\n';
  }
  for (std::size_t i = 0; i < hull.simplices.size(); ++i) {
    const auto at = static_cast<std::uint64_t>(
        std::lower_bound(hull.vertices.begin(), hull.vertices.end(), hull.simplices[i]) -
        hull.vertices.begin());
    obj += i % 3 == 0 ? "f " : " ";
    off += i % 3 == 0 ? "3 " : " ";
    internal::append_number(obj, at + 1);
    internal::append_number(off, at);
    if (i % 3 == 2) obj += '\n', off += '\n';
  }
  for (const auto& [name, expected] :
       {std::pair("a.json", &json), {"a.obj", &obj}, {"a.off", &off}}) {
    write_hull(folder.file(name), view, hull);
    EXPECT_TRUE(slurp(folder.file(name)) == *expected) << name;
  }
}

TEST(Mesh, EveryFormatReadsBack) {
  for (const char* format : {"ply", "off", "obj"})
    EXPECT_EQ(rows_of(parse(written(cube(), "a", format), format).view), corners()) << format;
  const std::string ply = written(cube(), "a.ply", "", Faces::polygons);
  EXPECT_EQ(parse(ply, "").in_place, lies_ready);
  EXPECT_EQ(ply.substr(ply.size() - 17), bytes_of(std::uint8_t{4}, 4, 5, 7, 6));
}

TEST(Mesh, CoordinatesAreExact) {
  Example e = cube();
  const double odd[] = {0.1, 1.0 / 3, 5e-324, 1.7976931348623157e308, -1e-300, 123456789.123456789};
  for (std::size_t i = 0; i < 6; ++i) e.coordinates[3 + i] = odd[i];
  for (const char* format : {"ply", "off", "obj"}) {
    const auto rows = rows_of(parse(written(e, "a", format), format).view);
    EXPECT_EQ(rows[0], (std::vector<double>{odd[0], odd[1], odd[2]})) << format;
    EXPECT_EQ(rows[1], (std::vector<double>{odd[3], odd[4], odd[5]})) << format;
  }
}

TEST(Mesh, StlTrianglesFaceOutward) {
  const std::string stl = written(cube(), "a.stl");
  ASSERT_EQ(stl.size(), 84U + 12 * 50);
  double volume = 0;
  for (std::size_t t = 0; t < 12; ++t) {
    float v[12];
    std::memcpy(v, stl.data() + 84 + 50 * t, sizeof v);
    internal::little_endian_items(v, sizeof v, sizeof v[0]);
    const auto det = [&](int a, int b, int c) {
      return static_cast<double>(v[3 + a]) * (v[6 + b] * v[9 + c] - v[6 + c] * v[9 + b]);
    };
    volume += (det(0, 1, 2) + det(1, 2, 0) + det(2, 0, 1)) / 6;
    // The normal is the axis whose coordinate all three corners share, away from the centre.
    for (int j = 0; j < 3; ++j) {
      const bool same = v[3 + j] == v[6 + j] && v[3 + j] == v[9 + j];
      EXPECT_EQ(v[j], same ? 2 * v[3 + j] - 1 : 0) << t;
    }
  }
  EXPECT_DOUBLE_EQ(volume, 1);
  EXPECT_EQ(parse(stl, "stl").view.count, 36U);
  EXPECT_EQ(written(square(), "a.stl").size(), 84U + 2 * 50);
}

TEST(Mesh, LongPolygonsHaveAWiderCount) {
  Example e;
  Hull& h = e.hull;
  h.dimension = 2;
  h.affine_dimension = 2;
  h.point_count = 300;
  for (std::uint64_t i = 0; i < 300; ++i) {
    e.coordinates.push_back(std::cos(static_cast<double>(i)));
    e.coordinates.push_back(std::sin(static_cast<double>(i)));
    h.vertices.push_back(i);
  }
  const std::string ply = written(e, "a.ply", "", Faces::polygons);
  EXPECT_TRUE(has(ply, "property list uint int vertex_indices"));
  EXPECT_EQ(ply.substr(ply.size() - 4 * 301, 4), bytes_of(300));
  EXPECT_EQ(parse(ply, "ply").view.count, 300U);
}

TEST(Mesh, SegmentsPointsAndNothing) {
  Example e;
  e.coordinates = {0, 0, 0, 1, 2, 3};
  e.hull.dimension = 3;
  e.hull.point_count = 2;
  e.hull.affine_dimension = 1;
  e.hull.vertices = {0, 1};
  EXPECT_EQ(written(e, "a.off"), "OFF\n2 0 0\n0 0 0\n1 2 3\n");
  error_of(ErrorCode::invalid_argument, [&] { written(e, "a.stl"); });
  e.hull.point_count = 0;
  e.hull.affine_dimension = -1;
  e.hull.vertices.clear();
  EXPECT_EQ(parse(written(e, "a.ply"), "ply").view.count, 0U);
}

TEST(Mesh, RefusesWhatAFormatCannotHold) {
  const TemporaryFolder folder;
  Example e = cube();
  e.hull.dimension = 4;
  e.coordinates.resize(36);
  for (const char* name : {"a.ply", "a.obj", "a.off", "a.stl"})
    EXPECT_TRUE(has(error_of(ErrorCode::invalid_argument,
                             [&] { write_hull(folder.file(name), e.view(), e.hull); }),
                    "4D"));
  error_of(ErrorCode::invalid_argument,
           [&] { write_hull(folder.file("a.las"), cube().view(), cube().hull); });
  const Example far = [] {
    Example x = cube();
    x.coordinates[3] = 1e39;
    return x;
  }();
  error_of(ErrorCode::invalid_argument,
           [&] { write_hull(folder.file("a.stl"), far.view(), far.hull); });
  error_of(ErrorCode::invalid_argument,
           [&] { write_hull(folder.file("a.off"), square().view(), cube().hull); });
  EXPECT_EQ(folder.entries(), 0U);
}

// The expectations below are what `qconvex` 2020.2 prints for these points, but for the order of
// facets and where a facet's list begins.
TEST(QhullText, Cube) {
  const Example e = cube();
  const auto text = [&](const char* what) { return hull_to_qhull_text(e.view(), e.hull, what); };
  EXPECT_EQ(text("Fx"), "8\n1\n2\n3\n4\n5\n6\n7\n8\n");
  EXPECT_EQ(text("i"), "6\n5 6 2 1 \n2 4 3 1 \n3 7 5 1 \n6 8 4 2 \n4 8 7 3 \n7 8 6 5 \n");
  EXPECT_EQ(text("o").substr(0, 29), "3\n9 6 12\n   0.5    0.5    0.5");
  EXPECT_TRUE(has(text("o"), "     1      1      1 \n4 5 6 2 1 \n"));
  EXPECT_EQ(text("n").substr(0, 32), "4\n6\n     0     -1      0      0 ");
  EXPECT_EQ(text("p").substr(0, 26), "3\n8\n     0      0      0 \n");
  EXPECT_EQ(text("FV"), "3 1\n   0.5    0.5    0.5 \n");
  EXPECT_EQ(text("FS"), "0\n2      6      1 \n");
  error_of(ErrorCode::invalid_argument, [&] { text("Fy"); });
  EXPECT_EQ(written(e, "a", "Fx"), text("Fx"));
  EXPECT_EQ(rows_of(parse(written(e, "a.txt"), "txt").view), corners());
  EXPECT_EQ(rows_of(parse(text("o"), "off").view)[0], (std::vector<double>{0.5, 0.5, 0.5}));
}

TEST(QhullText, SquareIsCounterClockwise) {
  const Example e = square();
  EXPECT_EQ(hull_to_qhull_text(e.view(), e.hull, "Fx"), "4\n0\n1\n4\n3\n");
  EXPECT_EQ(hull_to_qhull_text(e.view(), e.hull, "i"), "4\n0 1 \n3 0 \n1 4 \n4 3 \n");
  EXPECT_EQ(hull_to_qhull_text(e.view(), e.hull, "p"),
            "2\n4\n     0      0 \n     1      0 \n     0      1 \n     1      1 \n");
}

/// The simplex 0, e1, ..., e4: its facets as this library orients them, outward.
TEST(QhullText, FourDimensionsAreOrientedAsQhullDoes) {
  Example e;
  Hull& h = e.hull;
  h.dimension = 4;
  h.affine_dimension = 4;
  h.point_count = 5;
  e.coordinates.assign(20, 0);
  for (std::size_t i = 0; i < 4; ++i) e.coordinates[4 * (i + 1) + i] = 1;
  h.vertices = {0, 1, 2, 3, 4};
  const auto det = [&](const std::vector<std::uint64_t>& s) {
    // det of (v1 - v0, v2 - v0, v3 - v0, centre - v0), by Gauss on a small integer matrix.
    double m[4][4];
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = 0; j < 4; ++j)
        m[i][j] = (i < 3 ? e.coordinates[4 * s[i + 1] + j] : 0.2) - e.coordinates[4 * s[0] + j];
    double d = 1;
    for (std::size_t i = 0; i < 4; ++i) {
      std::size_t p = i;
      for (std::size_t r = i; r < 4; ++r)
        if (std::fabs(m[r][i]) > std::fabs(m[p][i])) p = r;
      if (p != i) {
        std::swap_ranges(m[p], m[p] + 4, m[i]);
        d = -d;
      }
      d *= m[i][i];
      for (std::size_t r = i + 1; r < 4; ++r)
        for (std::size_t c = 4; c-- > i;) m[r][c] -= m[i][c] * m[r][i] / m[i][i];
    }
    return d;
  };
  for (std::uint32_t left_out = 5; left_out-- > 0;) {
    std::vector<std::uint64_t> s;
    for (std::uint64_t v = 0; v < 5; ++v)
      if (v != left_out) s.push_back(v);
    h.facets.items.edit().insert(h.facets.items.edit().end(), s.begin(), s.end());
    h.facets.offsets.push_back(h.facets.items.size());
    if (det(s) > 0) std::swap(s[2], s[3]);  // outward: the inside is at the negative side
    h.simplices.edit().insert(h.simplices.edit().end(), s.begin(), s.end());
    h.simplex_facets.push_back(4 - left_out);
  }
  h.facet_neighbours.items.assign(20, 0);
  for (const char* what : {"i", "o"}) {
    const std::string text = hull_to_qhull_text(e.view(), e.hull, what);
    std::istringstream lines(text);
    std::string line;
    int facets = 0;
    std::size_t skip = *what == 'i' ? 1 : 7;
    while (std::getline(lines, line)) {
      if (skip > 0) {
        --skip;
        continue;
      }
      std::istringstream in(line);
      std::vector<std::uint64_t> s(4);
      if (*what == 'o') in >> s[0];
      for (auto& v : s) in >> v;
      EXPECT_GT(det(s), 0) << line;
      ++facets;
    }
    EXPECT_EQ(facets, 5);
  }
}

}  // namespace cullhull::testing::io_write_test
