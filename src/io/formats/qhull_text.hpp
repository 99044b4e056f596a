// Functions that the writers of Qhull's texts share.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "cullhull/hull.hpp"
#include "cullhull/io.hpp"
#include "io/coordinates.hpp"

namespace cullhull::internal {

/// The vertices of a facet in Qhull's order: det(v1 - v0, ..., x - v0) > 0 for x inside.
std::vector<std::uint64_t> qhull_facet(const Hull& hull, std::uint64_t facet,
                                       std::uint64_t one_of_its_simplices);

/// One simplex of every facet.
std::vector<std::uint64_t> simplex_of_facet(const Hull& hull);

/// The average of the points with these ids, summed so that huge coordinates do not overflow.
std::vector<double> average_of(const Coordinates& points, const std::vector<std::uint64_t>& ids);

/// The (k-1)-measure of each facet.
std::vector<double> facet_measures(const Coordinates& points, const Hull& hull);

/// "%6s ", as Qhull pads its numbers.
void append_padded(std::string& out, double v);
void append_line(std::string& out, std::uint64_t v);
void append_point(std::string& out, const Coordinates& points, std::uint64_t id);
void append_ids(std::string& out, const std::vector<std::uint64_t>& ids);

/// For programs that draw: Geomview (G), Mathematica (m), Maple (FM). Error{invalid_argument}
/// unless the hull is full-dimensional and of 2D or 3D points.
std::string geomview_text(const Coordinates& points, const Hull& hull);
std::string mathematica_text(const Coordinates& points, const Hull& hull);
std::string maple_text(const Coordinates& points, const Hull& hull);

}  // namespace cullhull::internal
