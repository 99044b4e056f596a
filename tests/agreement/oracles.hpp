// Who are the extreme points? Answers that share no code with the library: linear programs in exact
// integers, and other programs run as processes.
#pragma once

#include <gmpxx.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "cullhull/point_view.hpp"

namespace cullhull::testing_support {

using Ids = std::vector<std::uint64_t>;

struct PointSet {
  std::string name;
  unsigned dimension = 0;
  std::vector<double> coordinates;  // row-major

  std::uint64_t count() const { return coordinates.size() / dimension; }
  const double* row(std::uint64_t i) const { return &coordinates[i * dimension]; }
  void add(const std::vector<double>& p) {
    coordinates.insert(coordinates.end(), p.begin(), p.end());
  }
};

inline PointView view_of(const PointSet& s) {
  return PointView::row_major(s.coordinates.data(), s.count(), s.dimension);
}

using IntegerRow = std::vector<mpz_class>;

/// The distinct points, each axis multiplied by the power of two that makes it integral: hulls do
/// not change under that. `ids` are the lowest of each group of equal points.
struct IntegerSet {
  std::vector<IntegerRow> rows;
  Ids ids;

  explicit IntegerSet(const PointSet& s) {
    const unsigned d = s.dimension;
    std::vector<int> shift(d, 0);
    for (std::uint64_t i = 0; i < s.count(); ++i)
      for (unsigned j = 0; j < d; ++j) {
        int e = 0;
        const double m = std::frexp(s.row(i)[j], &e);
        if (m != 0) shift[j] = std::max(shift[j], trailing_bit(m) - e);
      }
    std::map<IntegerRow, std::uint64_t> seen;
    for (std::uint64_t i = 0; i < s.count(); ++i) {
      IntegerRow row(d);
      for (unsigned j = 0; j < d; ++j) row[j] = scaled(s.row(i)[j], shift[j]);
      if (!seen.emplace(row, i).second) continue;
      rows.push_back(std::move(row));
      ids.push_back(i);
    }
  }

 private:
  /// The k with m * 2^k an odd integer, |m| in [0.5, 1).
  static int trailing_bit(double m) {
    int k = 0;
    while (m != std::floor(m)) {
      m *= 2;
      ++k;
    }
    return k;
  }
  static mpz_class scaled(double v, int shift) {
    int e = 0;
    const double m = std::frexp(v, &e);
    mpz_class z = static_cast<long>(std::ldexp(m, 53));
    const int by = e - 53 + shift;  // the value is an integer: a right shift is exact
    if (by >= 0)
      z <<= static_cast<mp_bitcnt_t>(by);
    else
      mpz_tdiv_q_2exp(z.get_mpz_t(), z.get_mpz_t(), static_cast<mp_bitcnt_t>(-by));
    return z;
  }
};

/// Whether p is outside the hull of `others`; then `direction` is one in which p is strictly
/// farther than all of them. Phase one of the simplex method for
///     sum l_j (q_j - p) = 0, sum l_j = 1, l >= 0
/// on an integer tableau (all entries over one denominator, divisions exact), with Bland's rule;
/// the dual of an infeasible system is the direction.
inline bool separated(const IntegerRow& p, const std::vector<const IntegerRow*>& others,
                      IntegerRow& direction) {
  const std::size_t d = p.size(), m = d + 1, n = others.size(), width = n + m + 1;
  std::vector<IntegerRow> t(m + 1, IntegerRow(width));
  for (std::size_t j = 0; j < n; ++j) {
    for (std::size_t i = 0; i < d; ++i) t[i][j] = (*others[j])[i] - p[i];
    t[d][j] = 1;
    for (std::size_t i = 0; i < m; ++i) t[m][j] -= t[i][j];
  }
  for (std::size_t i = 0; i < m; ++i) t[i][n + i] = 1;
  t[d][width - 1] = 1;
  t[m][width - 1] = -1;
  std::vector<std::size_t> basis(m);
  for (std::size_t i = 0; i < m; ++i) basis[i] = n + i;
  mpz_class denominator = 1, left, right;
  for (;;) {
    std::size_t enter = 0;
    while (enter < n && t[m][enter] >= 0) ++enter;
    if (enter == n) break;
    std::size_t leave = m;
    for (std::size_t i = 0; i < m; ++i) {
      if (t[i][enter] <= 0) continue;
      if (leave == m) {
        leave = i;
        continue;
      }
      left = t[i][width - 1] * t[leave][enter];
      right = t[leave][width - 1] * t[i][enter];
      if (left < right || (left == right && basis[i] < basis[leave])) leave = i;
    }
    if (leave == m) throw std::logic_error("phase one is bounded");
    const mpz_class pivot = t[leave][enter];
    for (std::size_t i = 0; i <= m; ++i) {
      if (i == leave) continue;
      const mpz_class factor = t[i][enter];
      for (std::size_t j = 0; j < width; ++j) {
        mpz_class& v = t[i][j];
        v *= pivot;
        mpz_submul(v.get_mpz_t(), factor.get_mpz_t(), t[leave][j].get_mpz_t());
        mpz_divexact(v.get_mpz_t(), v.get_mpz_t(), denominator.get_mpz_t());
      }
    }
    denominator = pivot;
    basis[leave] = enter;
  }
  if (t[m][width - 1] == 0) return false;
  direction.assign(d, 0);
  // All others lie where the dual is not positive, p where it is; w is larger at p then.
  for (std::size_t i = 0; i < d; ++i) direction[i] = denominator - t[m][n + i];
  return true;
}

/// Lowest ids of all extreme points, ascending, in any dimension and for flat sets. Clarkson's
/// scheme: a point outside the hull of the extreme points known leads to another one.
inline Ids exact_extreme_points(const PointSet& set) {
  const IntegerSet integers(set);
  const std::size_t n = integers.rows.size();
  std::vector<char> extreme(n, 0);
  IntegerRow w;
  for (std::size_t i = 0; i < n; ++i) {
    while (!extreme[i]) {
      std::vector<const IntegerRow*> known;
      for (std::size_t j = 0; j < n; ++j)
        if (extreme[j]) known.push_back(&integers.rows[j]);
      if (known.empty())
        w.assign(set.dimension, 0);  // the lexicographically greatest point is extreme
      else if (!separated(integers.rows[i], known, w))
        break;
      std::size_t best = n;
      mpz_class best_value;
      for (std::size_t j = 0; j < n; ++j) {
        mpz_class value = 0;
        for (unsigned k = 0; k < set.dimension; ++k) value += w[k] * integers.rows[j][k];
        if (best == n || value > best_value ||
            (value == best_value && integers.rows[j] > integers.rows[best])) {
          best = j;
          best_value = value;
        }
      }
      if (extreme[best]) throw std::logic_error("a known point separates itself");
      extreme[best] = 1;
    }
  }
  Ids out;
  for (std::size_t i = 0; i < n; ++i)
    if (extreme[i]) out.push_back(integers.ids[i]);
  return out;
}

/// What `command` printed; throws if it failed. stdin comes from `input`; `by_name`: it is a file
/// that the command's last word names.
inline std::string output_of(const std::string& command, const std::string& input = "",
                             bool by_name = false) {
  char name[] = "/tmp/cullhull-oracle-XXXXXX";
  const int file = mkstemp(name);
  if (file < 0) throw std::runtime_error("cannot make a temporary file");
  std::FILE* f = fdopen(file, "w");
  const bool written = std::fwrite(input.data(), 1, input.size(), f) == input.size();
  if (std::fclose(f) != 0 || !written) throw std::runtime_error("cannot write a temporary file");
  std::FILE* pipe = popen((command + (by_name ? " " : " < ") + name).c_str(), "r");
  if (!pipe) throw std::runtime_error("cannot run " + command);
  std::string out;
  char buffer[65536];
  for (std::size_t k; (k = std::fread(buffer, 1, sizeof buffer, pipe)) > 0;) out.append(buffer, k);
  const int status = pclose(pipe);
  std::remove(name);
  if (status != 0) throw std::runtime_error(command + " failed: " + out.substr(0, 400));
  return out;
}

inline std::string as_qhull_text(const PointSet& s) {
  std::string out = std::to_string(s.dimension) + "\n" + std::to_string(s.count()) + "\n";
  char word[40];
  for (std::size_t i = 0; i < s.coordinates.size(); ++i) {
    std::snprintf(word, sizeof word, "%.17g ", s.coordinates[i]);
    out += word;
    if ((i + 1) % s.dimension == 0) out += '\n';
  }
  return out;
}

/// Qhull's extreme points: an oracle in general position only.
inline Ids qconvex_extreme_points(const std::string& qconvex, const PointSet& s) {
  std::istringstream in(output_of(qconvex + " Fx", as_qhull_text(s)));
  std::size_t n = 0;
  in >> n;
  Ids ids(n);
  for (auto& id : ids) in >> id;
  if (!in) throw std::runtime_error("cannot read qconvex's answer");
  std::sort(ids.begin(), ids.end());
  return ids;
}

/// "D n" as rbox prints them, then the points.
inline PointSet rbox(const std::string& program, const std::string& arguments) {
  PointSet s;
  s.name = "rbox " + arguments;
  std::istringstream in(output_of(program + " n " + arguments));
  std::uint64_t n = 0;
  in >> s.dimension >> n;
  s.coordinates.resize(n * s.dimension);
  for (double& v : s.coordinates) in >> v;
  if (!in || s.dimension == 0) throw std::runtime_error("cannot read the points of " + s.name);
  return s;
}

/// The rows between the last "begin" and "end" of lrslib's format without the size: lrs begins
/// anew, header and all, when its integers overflow.
inline std::vector<std::string> lrs_rows(const std::string& text) {
  std::istringstream in(text);
  std::string line;
  std::vector<std::string> rows;
  bool begun = false, ended = false;
  while (!ended && std::getline(in, line)) {
    if (line.rfind("begin", 0) == 0) {
      begun = true;
      rows.clear();
      std::getline(in, line);
    } else if (line.rfind("end", 0) == 0) {
      ended = true;
    } else if (begun) {
      rows.push_back(line);
    }
  }
  if (!ended) throw std::runtime_error("lrslib's answer has no end");
  return rows;
}

/// lrs 7.3 reads its input again where its integers overflow, which standard input does not allow.
inline std::string lrs_output(const std::string& lrs, const std::string& text) {
  return output_of(lrs, text, true);
}

inline std::string as_lrs_text(const IntegerSet& s, unsigned d) {
  std::ostringstream out;
  out << "cullhull\nV-representation\nbegin\n" << s.rows.size() << ' ' << d + 1 << " integer\n";
  for (const IntegerRow& row : s.rows) {
    out << '1';
    for (const mpz_class& v : row) out << ' ' << v.get_str();
    out << '\n';
  }
  out << "end\n";
  return out.str();
}

/// The number of facets of a full-dimensional hull, by lrs: exact, by reverse search.
inline std::uint64_t lrs_facet_count(const std::string& lrs, const PointSet& s) {
  const std::vector<std::string> rows =
      lrs_rows(lrs_output(lrs, as_lrs_text(IntegerSet(s), s.dimension)));
  return std::set<std::string>(rows.begin(), rows.end()).size();
}

/// Extreme points by the redundancy option of lrs.
inline Ids lrs_extreme_points(const std::string& lrs, const PointSet& s) {
  const IntegerSet integers(s);
  std::map<std::string, std::uint64_t> id_of;
  for (std::size_t i = 0; i < integers.rows.size(); ++i) {
    std::string key;
    for (const mpz_class& v : integers.rows[i]) key.append(" ").append(v.get_str());
    id_of[key] = integers.ids[i];
  }
  Ids ids;
  for (const std::string& row :
       lrs_rows(lrs_output(lrs, as_lrs_text(integers, s.dimension) + "redund 0 0\n"))) {
    std::istringstream in(row);
    std::string word, key;
    in >> word;
    while (in >> word) key.append(" ").append(word);
    ids.push_back(id_of.at(key));
  }
  std::sort(ids.begin(), ids.end());
  return ids;
}

}  // namespace cullhull::testing_support
