// Result files spoilt in every way: each change of meaning is refused, what means the same is not.
// CULLHULL_MUTATIONS says how many (a few thousand if unset), CULLHULL_RANDOM_SEED where the random
// numbers start.
#include <gtest/gtest.h>

#include <iostream>
#include <nlohmann/json.hpp>

#include "agreement/hard_sets.hpp"
#include "agreement/random_seeds.hpp"
#include "exactness/slow_numbers.hpp"
#include "io/certify_file.hpp"
#include "io/json/json.hpp"

namespace cullhull::testing_support {
namespace certify_mutations_test {

using nlohmann::json;
using Verdict = SlowNumbers::Verdict;

// ---------------------------------------------------------------------------------------------
// Sets

PointSet stretched_box(unsigned d, Random& r) {
  PointSet s = full_grid(d, 2, -r.integer(0, 1) * 0.5);
  s.name = "stretched box";
  for (unsigned j = 0; j < d; ++j) {
    const double side = std::pow(10, r.integer(-8, 8));
    for (std::size_t i = j; i < s.coordinates.size(); i += d) s.coordinates[i] *= side;
  }
  if (r.integer(0, 2) == 0 && d > 1) turn_axes(s, 0, d - 1, r.between(0, 3));
  return s;
}

PointSet scaled_set(unsigned d, Random& r) {
  PointSet s = random_set(r.integer(0, 1) ? "sphere" : "cube", d + 1 + r.integer(0, 6), d,
                          static_cast<std::uint64_t>(r.integer(0, 1 << 20)));
  const int exponents[] = {-1040, -1020, -500, 500, 1000, 1022};
  const int e = exponents[r.integer(0, 5)];
  s.name = "scaled " + s.name + " by 2^" + std::to_string(e);
  for (double& v : s.coordinates) v = std::ldexp(v, e);
  return s;
}

/// Points of a plane or of a lattice in it, turned: rounding leaves hulls as thin as it is, for
/// which bounds of measures exceed the measures.
PointSet thin_set(Random& r) {
  const auto d = static_cast<unsigned>(r.integer(2, 5)), k = d - 1;
  const bool lattice = r.integer(0, 1) == 0;
  PointSet s = named(lattice ? "turned lattice" : "turned plane", d);
  const unsigned n = k == 1 ? 6 : k == 2 ? 16 : k + 4;
  for (unsigned i = 0; i < n; ++i) {
    std::vector<double> p(d, 0);
    for (unsigned c = 0; c < k; ++c) p[c] = lattice ? r.integer(-2, 2) : r.between(-2, 2);
    s.add(p);
  }
  for (unsigned c = 0; c < k; ++c) turn_axes(s, c, d - 1, r.between(0, 3));
  return s;
}

/// Dimensions in which normals are eliminated.
PointSet set_of_many_dimensions(Random& r) {
  const auto d = static_cast<unsigned>(r.integer(9, 11));
  const auto seed = static_cast<std::uint64_t>(r.integer(0, 1 << 20));
  if (r.integer(0, 3) == 0)
    return flat(d, static_cast<unsigned>(r.integer(1, 7)), d, 6, seed % 1000);
  PointSet s = random_set(r.integer(0, 1) ? "sphere" : "cube",
                          d + 1 + static_cast<unsigned>(r.integer(0, d == 9 ? 1 : 0)), d, seed);
  const int step = r.integer(0, 2) * r.integer(-40, 40);
  for (std::size_t i = 0; i < s.coordinates.size(); ++i)
    s.coordinates[i] = std::ldexp(s.coordinates[i], static_cast<int>(i % d) * step);
  return s;
}

PointSet any_small_set(Random& r) {
  const auto d = static_cast<unsigned>(r.integer(1, 8));
  switch (r.integer(0, 9)) {
    case 0:
      return stretched_box(static_cast<unsigned>(r.integer(1, 4)), r);
    case 1:
      return scaled_set(std::min(d, 6U), r);
    case 2: {
      const auto k = static_cast<unsigned>(r.integer(0, static_cast<int>(d)));
      return flat(static_cast<unsigned>(r.integer(1, 12)), k, d, 6,
                  static_cast<std::uint64_t>(r.integer(0, 1000)));
    }
    case 3:
      return random_grid(static_cast<unsigned>(r.integer(1, 12)), std::min(d, 5U), r.integer(2, 4),
                         0, static_cast<std::uint64_t>(r.integer(0, 1000)));
    case 4:
      return random_set("sphere", static_cast<unsigned>(r.integer(1, 14)), d,
                        static_cast<std::uint64_t>(r.integer(0, 1000)));
    case 5:
      return thin_set(r);
    case 6:
      return set_of_many_dimensions(r);
    default:
      return hard_set(r);
  }
}

// ---------------------------------------------------------------------------------------------
// What changes the meaning

bool is_measure(const std::string& key) {
  return key == "length" || key == "perimeter" || key == "area" || key == "volume";
}

class Judge {
 public:
  Judge(const PointSet& s, const Hull& h, const json& good) : h_(h), good_(good) {
    if (h.affine_dimension > 0) slow_.emplace(s, h);
  }

  Verdict judge(const json& bad) {
    Verdict all = Verdict::right;
    for (const auto& [key, value] : good_.items()) {
      if (key == "version" || key == "kind" || key == "schema" || all == Verdict::wrong) continue;
      if (!bad.contains(key)) return Verdict::wrong;
      all = std::max(all, judge(key, value, bad[key]));
    }
    return all;
  }

 private:
  static bool is_real(const std::string& key) {
    return is_measure(key) || key == "centroid" || key == "facet_planes";
  }
  /// NaN stands for what is no number.
  static double real(const json& v) {
    if (v.is_number()) return v.get<double>();
    if (v == "inf") return std::numeric_limits<double>::infinity();
    if (v == "-inf") return -std::numeric_limits<double>::infinity();
    return std::numeric_limits<double>::quiet_NaN();
  }
  Verdict judge(const std::string& key, const json& good, const json& bad) {
    if (!is_real(key) || !slow_) return good == bad ? Verdict::right : Verdict::wrong;
    if (key == "perimeter" || (key == "area" && h_.affine_dimension != 2))
      return slow_->judge_area(real(bad));
    if (is_measure(key)) return slow_->judge_volume(real(bad));
    if (!bad.is_array() || bad.size() != good.size()) return Verdict::wrong;
    Verdict all = Verdict::right;
    for (std::size_t i = 0; i < bad.size(); ++i) {
      if (bad[i] == good[i]) continue;
      if (key == "centroid") {
        all = std::max(all, slow_->judge_centroid(static_cast<unsigned>(i), real(bad[i])));
        continue;
      }
      if (!bad[i].is_array() || bad[i].size() != good[i].size()) return Verdict::wrong;
      std::vector<double> row;
      for (const json& v : bad[i]) row.push_back(real(v));
      all = std::max(all, slow_->judge(i, row.data()));
    }
    return all;
  }

  const Hull& h_;
  const json& good_;
  std::optional<SlowNumbers> slow_;
};

// ---------------------------------------------------------------------------------------------
// Mutations

json other_number(const json& old, bool real, Random& r) {
  const double v = old.is_number() ? old.get<double>() : 0;
  if (!real) {
    const std::int64_t n = old.is_number_integer() ? old.get<std::int64_t>() : 0;
    const std::int64_t choice[] = {n + 1,     n - 1,          0, -n, 2 * n + 1, r.integer(0, 30),
                                   1LL << 32, (1LL << 62) + n};
    return choice[r.integer(0, 7)];
  }
  const auto either = [&] { return r.integer(0, 1) ? 1 : -1; };
  const json choice[] = {-v,
                         std::nextafter(v, v + 1),
                         v * (1 + std::ldexp(either(), -r.integer(1, 53))),
                         v + std::ldexp(either(), -r.integer(1, 60)),
                         v + std::ldexp(either(), r.integer(-1074, 1000)),
                         0.0,
                         "inf",
                         "-inf",
                         nullptr,
                         std::isfinite(2 * v) ? 2 * v : v,
                         5e-324,
                         std::isfinite(v) ? v * (1 - 0x1p-40) : 1.0,
                         1.0,
                         r.between(-1, 1)};
  return choice[r.integer(0, 13)];
}

/// One entry of a list, or the whole list; deeper where the list is one of lists.
void spoil_list(json& list, bool real, Random& r) {
  if (!list.empty() && list[0].is_array() && r.integer(0, 3) > 0)
    return spoil_list(
        list[static_cast<std::size_t>(r.integer(0, static_cast<int>(list.size()) - 1))], real, r);
  const auto n = static_cast<int>(list.size());
  const auto any = [&] { return static_cast<std::size_t>(r.integer(0, n - 1)); };
  switch (n == 0 ? 6 : r.integer(0, 9)) {
    case 0:
      list.erase(any());
      break;
    case 1:
      list.insert(list.begin() + r.integer(0, n), json(list[any()]));
      break;
    case 2: {
      const std::size_t a = any(), b = any();
      std::swap(list[a], list[b]);
      break;
    }
    case 3:
      std::reverse(list.begin(), list.end());
      break;
    case 4:
      std::rotate(list.begin(), list.begin() + 1, list.end());
      break;
    case 5:
      list = json::array();
      break;
    case 6:
      list.push_back(n > 0 ? list[any()] : json(0));
      break;
    default: {
      json& entry = list[any()];
      if (!entry.is_array()) entry = other_number(entry, real, r);
    }
  }
}

/// All facets' planes alike, or lists that belong together consistently.
void spoil_together(json& file, Random& r) {
  json& planes = file["facet_planes"];
  const int kind = r.integer(0, 5);
  if (planes.empty()) return;
  const auto f = static_cast<std::size_t>(r.integer(0, static_cast<int>(planes.size()) - 1));
  const auto numbers = [](json& row) {
    for (json& v : row)
      if (!v.is_number()) return false;
    return true;
  };
  if (kind == 0) {  // faces inward
    for (json& v : planes[f])
      if (v.is_number()) v = -v.get<double>();
  } else if (kind == 1) {  // a longer normal: the same plane
    for (json& v : planes[f])
      if (v.is_number()) v = v.get<double>() * (1 + std::ldexp(1, -r.integer(1, 52)));
  } else if (kind == 2 && numbers(planes[f]) && planes[f].size() > 2) {  // turned
    json& row = planes[f];
    const double angle = std::ldexp(1, -r.integer(1, 50)), a = row[0].get<double>(),
                 b = row[1].get<double>();
    row[0] = a * std::cos(angle) - b * std::sin(angle);
    row[1] = a * std::sin(angle) + b * std::cos(angle);
  } else if (kind == 3) {  // every offset infinite
    for (json& row : planes) row.back() = r.integer(0, 1) ? "inf" : "-inf";
  } else if (kind == 4) {  // a facet's list turned, and its neighbours with it
    json &list = file["facets"][f], &across = file["facet_neighbours"][f];
    if (list.size() != across.size()) return;
    std::rotate(list.begin(), list.begin() + 1, list.end());
    std::rotate(across.begin(), across.begin() + 1, across.end());
  } else if (file["simplices"][0].size() > 1) {  // inside out
    for (const char* key : {"simplices", "simplex_neighbours"})
      for (json& row : file[key]) std::swap(row[row.size() - 1], row[row.size() - 2]);
  }
}

constexpr const char* fields[] = {
    "length",      "perimeter",          "points",         "affine_dimension", "vertex_count",
    "facet_count", "simplex_count",      "area",           "volume",           "centroid",
    "vertices",    "vertex_coordinates", "facets",         "facet_neighbours", "facet_planes",
    "simplices",   "simplex_neighbours", "simplex_facets", "together",         "area",
    "volume",      "centroid",           "perimeter"};

void spoil(json& file, const std::string& field, Random& r) {
  if (field == "together") return spoil_together(file, r);
  if (!file.contains(field)) return;  // no measure of this dimension
  json& value = file[field];
  const bool real = is_measure(field) || field == "centroid" || field == "facet_planes" ||
                    field == "vertex_coordinates";
  if (r.integer(0, 40) == 0) {
    if (r.integer(0, 1))
      file.erase(field);
    else
      value = r.integer(0, 1) ? json::array() : json(r.integer(-2, 9));
  } else if (field == "points") {
    const int which = r.integer(0, 2);
    if (which == 2)
      value["scalar"] = r.integer(0, 1) ? "f32" : "u9";
    else
      value[which == 0 ? "count" : "dimension"] =
          other_number(value[which == 0 ? "count" : "dimension"], false, r);
  } else if (value.is_array()) {
    spoil_list(value, real, r);
  } else {
    value = other_number(value, real, r);
  }
}

// ---------------------------------------------------------------------------------------------

struct Count {
  std::uint64_t tried = 0, changed = 0, refused = 0, right = 0, doubtful = 0;
};

/// Empty if certified; what is unreadable is refused, too.
std::string verdict_of(const PointSet& s, const json& file) {
  const std::string text = file.dump();
  try {
    Options one;
    one.threads = 1;
    const Certificate c =
        internal::certify_source(view_of(s), {"F", text.data(), text.size()}, one);
    return c.valid ? "" : c.reason;
  } catch (const Error& e) {
    return e.what();
  }
}

TEST(CertifyMutations, WhatChangesTheMeaningIsRefused) {
  const std::uint64_t mutations = number_from_environment("CULLHULL_MUTATIONS", share_of(4000));
  const std::uint64_t first = number_from_environment("CULLHULL_RANDOM_SEED", 1);
  const std::uint64_t sets =
      std::min<std::uint64_t>(300, std::max<std::uint64_t>(mutations / 40, 1));
  std::map<std::string, Count> counts;
  std::uint64_t seed = first;
  for (std::uint64_t done = 0, set = 0; set < sets; ++set) {
    PointSet s;
    Hull hull;
    std::uint64_t own = 0;
    do {  // the reference is slow
      own = seed++;
      Random r(own);
      s = any_small_set(r);
      hull = Hull();
      if (s.count() > 3000) continue;
      Options one;
      one.threads = 1;
      hull = convex_hull(view_of(s), one);
    } while (hull.dimension == 0 || hull.simplex_count() * hull.dimension * hull.dimension > 2500);
    SCOPED_TRACE(s.name + ", CULLHULL_RANDOM_SEED=" + std::to_string(own));
    std::string text;
    internal::write_result_json(view_of(s), hull, [&](const std::string& t) { text += t; });
    const json good = json::parse(text);
    ASSERT_EQ(verdict_of(s, good), "");
    Judge judge(s, hull, good);
    Random r(own + 0x9E3779B9U);
    for (; done < mutations * (set + 1) / sets; ++done) {
      const std::string field = fields[r.integer(0, static_cast<int>(std::size(fields)) - 1)];
      json bad = good;
      spoil(bad, field, r);
      Count& count = counts[field];
      ++count.tried;
      if (bad == good) continue;
      ++count.changed;
      const Verdict verdict = judge.judge(bad);
      const std::string reason = verdict_of(s, bad);
      count.refused += !reason.empty();
      count.right += verdict == Verdict::right;
      count.doubtful += verdict == Verdict::doubtful;
      if (verdict == Verdict::wrong) {
        EXPECT_NE(reason, "") << field << ": " << json::diff(good, bad).dump().substr(0, 400);
      }
      if (verdict == Verdict::right) {
        EXPECT_EQ(reason, "") << field << ": " << json::diff(good, bad).dump().substr(0, 400);
      }
      if (HasFailure()) return;
    }
  }
  std::cout << "field: tried, changed, refused, within the bound, between bound and check\n";
  Count all;
  for (const auto& [field, c] : counts) {
    std::cout << field << ": " << c.tried << ", " << c.changed << ", " << c.refused << ", "
              << c.right << ", " << c.doubtful << "\n";
    all.tried += c.tried;
    all.changed += c.changed;
    all.refused += c.refused;
  }
  std::cout << "all: " << all.tried << ", " << all.changed << ", " << all.refused << "\n";
  EXPECT_GT(all.refused, all.tried / 2);
}

}  // namespace certify_mutations_test
}  // namespace cullhull::testing_support
