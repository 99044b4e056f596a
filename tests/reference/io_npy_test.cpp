#include <cmath>

#include "tests/io_fixtures.hpp"
#include "thrown.hpp"

namespace cullhull::testing::io_npy_test {

const std::string rows32 = "{'descr': '<f8', 'fortran_order': False, 'shape': (3, 2), }\n";

TEST(Npy, ReadsEveryScalarTypeInPlace) {
  const std::string tail = "', 'fortran_order': False, 'shape': (2, 1), }\n";
  const auto check =
      [&](const std::string& descr, const std::string& data, ScalarType type, Rows want) {
    const std::string bytes = npy("{'descr': '" + descr + tail, data);
    const auto points = parse(bytes, "npy");
    EXPECT_EQ(points.in_place, lies_ready || descr[0] == '|') << descr;
    EXPECT_EQ(points.view.scalar, type) << descr;
    EXPECT_EQ(rows_of(points.view), want) << descr;
    EXPECT_EQ(reinterpret_cast<const char*>(points.view.data) ==
                  bytes.data() + bytes.size() - data.size(),
              points.in_place);
  };
  check("<f8", bytes_of(1.5, -2.0), ScalarType::f64, {{1.5}, {-2}});
  check("<f4", bytes_of(1.5F, -2.0F), ScalarType::f32, {{1.5}, {-2}});
  check("|i1", bytes_of(std::int8_t{-128}, std::int8_t{7}), ScalarType::i8, {{-128}, {7}});
  check("|u1", bytes_of(std::uint8_t{255}, std::uint8_t{7}), ScalarType::u8, {{255}, {7}});
  check("<i2", bytes_of(std::int16_t{-300}, std::int16_t{7}), ScalarType::i16, {{-300}, {7}});
  check("<u2", bytes_of(std::uint16_t{65535}, std::uint16_t{7}), ScalarType::u16, {{65535}, {7}});
  check("<i4", bytes_of(std::int32_t{-70000}, std::int32_t{7}), ScalarType::i32, {{-70000}, {7}});
  check("<u4", bytes_of(4294967295U, 7U), ScalarType::u32, {{4294967295.0}, {7}});
}

TEST(Npy, RowsColumnsAndVectors) {
  const std::string data = bytes_of(1.0, 2.0, 3.0, 4.0, 5.0, 6.0);
  for (int version = 1; version <= 3; ++version) {
    const std::string bytes = npy(rows32, data, version);
    EXPECT_EQ(rows_of(parse(bytes, "npy").view), (Rows{{1, 2}, {3, 4}, {5, 6}}));
  }
  const std::string columns =
      npy("{'shape': (3L, 2L), 'fortran_order': True, \"descr\": '<f8'}", data);
  const auto c = parse(columns, "npy");
  EXPECT_EQ(c.in_place, lies_ready);
  EXPECT_EQ(c.view.point_stride, 8);
  EXPECT_EQ(c.view.coordinate_stride, 24);
  EXPECT_EQ(rows_of(c.view), (Rows{{1, 4}, {2, 5}, {3, 6}}));
  const std::string vector = npy("{'descr':'<f8','fortran_order':False,'shape':(6,)}", data);
  EXPECT_EQ(rows_of(parse(vector, "npy").view), (Rows{{1}, {2}, {3}, {4}, {5}, {6}}));
  const std::string none = npy("{'descr':'<f8','fortran_order':False,'shape':(0,4)}", "");
  EXPECT_EQ(parse(none, "npy").view.count, 0U);
  EXPECT_EQ(parse(none, "npy").view.dimension, 4U);
}

TEST(Npy, BigEndianIsCopied) {
  const std::string bytes = npy("{'descr':'>f8','fortran_order':False,'shape':(2,1)}",
                                bytes_of_big_endian(1.5) + bytes_of_big_endian(-3.0));
  const auto points = parse(bytes, "npy");
  EXPECT_NE(points.in_place, lies_ready);
  EXPECT_EQ(rows_of(points.view), (Rows{{1.5}, {-3}}));
}

TEST(Npy, WideIntegersOnlyWhereExact) {
  const std::string head = "{'descr':'<i8','fortran_order':False,'shape':(2,2)}";
  const std::int64_t big = std::int64_t{1} << 60;
  const std::string good =
      npy(head, bytes_of(big, std::int64_t{-5}, INT64_MIN, (std::int64_t{1} << 53)));
  EXPECT_EQ(rows_of(parse(good, "npy").view),
            (Rows{{std::ldexp(1, 60), -5}, {-std::ldexp(1, 63), std::ldexp(1, 53)}}));
  const std::string bad =
      npy(head, bytes_of(big, std::int64_t{-5}, big + 1, (std::int64_t{1} << 53) + 1));
  EXPECT_TRUE(has(refusal(bad, "npy"), "index (1, 0)"));
  const std::string top = npy(head, bytes_of(big, INT64_MAX, big, big));
  EXPECT_TRUE(has(refusal(top, "npy"), "index (0, 1)"));
  using U = std::uint64_t;
  const std::string columns = npy("{'descr':'<u8','fortran_order':True,'shape':(3,2)}",
                                  bytes_of(U{1}, U{2}, U{3}, U{4}, UINT64_MAX, U{5}));
  EXPECT_TRUE(has(refusal(columns, "npy"), "index (1, 1)"));
  const std::string swapped = npy("{'descr':'>u8','fortran_order':False,'shape':(1,)}",
                                  bytes_of_big_endian(std::uint64_t{77}));
  EXPECT_EQ(rows_of(parse(swapped, "npy").view), (Rows{{77}}));
}

TEST(Npy, OtherTypesAreNamed) {
  for (const std::string descr : {"|O", "<U5", "|S3", "<c16", "<f2", "|b1", "<M8[s]", "<f16", ""}) {
    const std::string bytes =
        npy("{'descr': '" + descr + "', 'fortran_order': False, 'shape': (1, 1), }",
            std::string(16, '\0'));
    EXPECT_TRUE(has(refusal(bytes, "npy"), "'" + descr + "'")) << descr;
  }
  for (const char* structured :
       {"[('x', '<f8', (1,))]", "[('a', '<f8')]", "[('x', [('q', '<f8')]), ('y', '<f8')]",
        "[('x', '|O'), ('y', '<f8')]", "[]", "[('x', '<f8'",
        "[('x', '<f8', (9999999999, 9999999999))]", "[('x', '<f9'), ('y', '<f8')]"})
    EXPECT_NE(refusal(npy("{'descr': " + std::string(structured) +
                              ", 'fortran_order': False, 'shape': (1,), }",
                          bytes_of(1.0)),
                      "npy"),
              "")
        << structured;
}

TEST(Npy, LiesAreCaught) {
  const std::string data = bytes_of(1.0, 2.0, 3.0, 4.0, 5.0, 6.0);
  const auto head = [](const std::string& shape) {
    return "{'descr': '<f8', 'fortran_order': False, 'shape': " + shape + ", }";
  };
  EXPECT_EQ(refusal(npy(head("(4, 2)"), data), "npy").find("F: byte 69: "), 0U);
  EXPECT_EQ(refusal(npy(head("(2, 2)"), data), "npy"), "F: byte 101: 16 bytes after the array");
  // n * d * 8 overflows to something small.
  EXPECT_EQ(refusal(npy(head("(2305843009213693952, 2)"), data), "npy").find("F: byte "), 0U);
  EXPECT_EQ(refusal(npy(head("(9223372036854775807, 4294967295)"), data), "npy").find("F: byte "),
            0U);
  EXPECT_TRUE(has(refusal(npy(head("(-3, 2)"), data), "npy"), "not negative"));
  EXPECT_TRUE(has(refusal(npy(head("(99999999999999999999, 2)"), data), "npy"), "whole numbers"));
  EXPECT_TRUE(has(refusal(npy(head("(3, 0)"), data), "npy"), "dimension 0"));
  EXPECT_TRUE(has(refusal(npy(head("(1, 3, 2)"), data), "npy"), "3 axes"));
  EXPECT_TRUE(has(refusal(npy(head("()"), data), "npy"), "0 axes"));
  EXPECT_TRUE(has(refusal(npy("{'descr': '<f8', }", data), "npy"), "needs descr"));
  EXPECT_TRUE(has(refusal(npy("{'shape': (1,), 'shape': (2,), }", data), "npy"), "twice"));
  EXPECT_TRUE(has(refusal(npy("{'order': 1}", data), "npy"), "unknown key 'order'"));
  const std::string whole = npy(rows32, data);
  for (std::size_t cut = 1; cut < whole.size(); ++cut)
    EXPECT_EQ(refusal(whole.substr(0, cut), "npy").find("F: byte "), 0U) << cut;
  std::string version = whole;
  version[6] = 9;
  EXPECT_EQ(refusal(version, "npy").find("F: byte 6: npy version 9"), 0U);
}

TEST(Npy, WritersAreReadBack) {
  const TemporaryFolder folder;
  const std::vector<double> v = {0.1, -0.0, 1e300, 4, 5, 6};
  write_npy_points(folder.file("a.npy"), v.data(), 3, 2, ScalarType::f64);
  const PointFile a = open_points(folder.file("a.npy"));
  EXPECT_EQ(a.mapped(), lies_ready);
  EXPECT_EQ(a.format(), "npy");
  EXPECT_EQ(rows_of(a.points()), (Rows{{0.1, -0.0}, {1e300, 4}, {5, 6}}));
  EXPECT_TRUE(std::signbit(a.points().at(0, 1)));
  EXPECT_EQ(std::filesystem::file_size(folder.file("a.npy")) % 16, 0U);
  if (lies_ready) {
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(a.points().data) % 64, 0U);
  }

  write_npy_points(folder.file("b.npy"), v.data() + 3, 1, 3, ScalarType::i16);
  EXPECT_EQ(open_points(folder.file("b.npy")).points().scalar, ScalarType::i16);
  EXPECT_EQ(rows_of(open_points(folder.file("b.npy")).points()), (Rows{{4, 5, 6}}));
  write_npy_points(folder.file("c.npy"), v.data(), 1, 2, ScalarType::f32);
  EXPECT_EQ(rows_of(open_points(folder.file("c.npy")).points()), (Rows{{0.1F, -0.0}}));
  for (const ScalarType type : {ScalarType::f32, ScalarType::u8, ScalarType::i32})
    error_of(ErrorCode::invalid_argument,
             [&] { write_npy_points(folder.file("d.npy"), v.data(), 3, 2, type); });
  EXPECT_FALSE(std::filesystem::exists(folder.file("d.npy")));

  write_npy_ids(folder.file("ids.npy"), {0, 7, std::uint64_t{1} << 40});
  EXPECT_EQ(rows_of(open_points(folder.file("ids.npy")).points()),
            (Rows{{0}, {7}, {std::ldexp(1, 40)}}));
  EXPECT_TRUE(has(slurp(folder.file("ids.npy")), "'shape': (3,), }"));
  EXPECT_EQ(folder.entries(), 4U);
}

}  // namespace cullhull::testing::io_npy_test
