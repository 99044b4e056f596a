#include "filter/planner.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

namespace cullhull::internal {
namespace {

/// Costs in nanoseconds on one thread, measured on balls (2.4 GHz Zen 3) and rounded: only their
/// ratios matter. Wrong constants cost time, never correctness.
struct Costs {
  double sample_point;  ///< hulling a sample, facets included, per point
  double engine_point;  ///< the engine's time per point that is not extreme
  double survivor;      ///< the later stages' time per survivor of the first map
  double pass;          ///< testing a point against the map
  double build;         ///< building the map
  double excess;        ///< share that the map keeps / share that its polytope would keep
  double largest_probe;
  double largest_sample;
  double leads;  ///< a survivor's time over that of a sampled point, where leaders are found
};

constexpr Costs costs_by_dimension[] = {
    {50, 15, 10, 3, 1e5, 1.05, 1000, 50000, 0},          // 2D
    {200, 100, 40, 5, 7e5, 1.05, 1000, 50000, 2},        // 3D
    {1500, 500, 500, 7, 6e6, 1.15, 500, 40000, 8},       // 4D
    {6000, 1500, 1000, 12, 14e6, 1.35, 1000, 30000, 8},  // 5D
    {3e4, 4000, 2000, 15, 23e6, 1.35, 500, 10000, 10},   // 6D
};

const Costs& costs_of(unsigned d) { return costs_by_dimension[std::clamp(d, 2U, 6U) - 2]; }

// Efron's identity in one example: let 130 of a random sample of 1,000 be extreme. A further point
// is outside of the sample's hull exactly if it is extreme among the 1,001: about 13 %. So a map of
// that sample keeps about 13 % of all points, and its own size tells so without a pass over the
// data. On a sphere all points are extreme: the share is 1, and the filter is skipped.

/// Estimates the share of points that a sample's hull leaves outside. Efron (1965): for m points it
/// is expected to be the share of an (m + 1)-sample's points that are extreme.
double kept_share(std::uint64_t sample, std::uint64_t extreme) {
  return static_cast<double>(std::max<std::uint64_t>(extreme, 1)) /
         static_cast<double>(std::max<std::uint64_t>(sample, 1));
}

/// Seconds to start the driver and create its context.
constexpr double device_start = 0.25;
/// Bytes of pinned memory made per second: the system locks and clears each page of 4 KB in about a
/// microsecond. Derived from that, not measured: the first call for points of the host pays it.
constexpr double pin_rate = 4e9;
/// Bytes per piece (uploaded_points), of which there are two; fewer if the points are few.
constexpr double pinned_piece = 8 << 20;
/// Seconds per call for launches and for waiting for the few words of the answer. Untested; matters
/// only near break-even.
constexpr double device_call = 100e-6;

/// Nanoseconds of one thread for a question to a hull of 2,000 (2D), 40,000, 20,000, 13,000 and
/// 12,000 (6D) facets of a sphere, the mean over points of a ball of 1.4 times its volume; from 5D
/// on, and of supports and distances, measured from Python. `cell`: building one. AMD EPYC.
struct QuestionCosts {
  double side, side_by_cells, cell, support, distance;
};
constexpr QuestionCosts question_costs[] = {{25, 12, 250, 170, 8.7e3},
                                            {60, 29, 900, 400, 22e3},
                                            {65, 51, 4500, 310, 10e3},
                                            {150, 150, 0, 480, 14e3},
                                            {210, 210, 0, 1700, 28e3}};

const QuestionCosts& question_costs_of(unsigned d) {
  return question_costs[std::clamp(d, 2U, 6U) - 2];
}

bool cpu_has_cells(const AskedPoints& points) {
  return points.cells > 0 &&
         (points.cells_built || points.count >= sides_worth_a_cell * points.cells);
}

// The estimates need not be right: they choose the way, never the answer. Example: a million
// points, 10,000 facets and cells that are built: 29 ns a side on the CPU are 29 ms on one thread.

/// Seconds for a question on the CPU: by cells where it has them or would build them (building is
/// not counted).
double question_seconds(const AskedPoints& points) {
  const QuestionCosts& c = question_costs_of(points.dimension);
  if (points.question == Question::supports) return 1e-9 * c.support;
  if (points.question == Question::distances) return 1e-9 * c.distance;
  return 1e-9 * (cpu_has_cells(points) ? c.side_by_cells : c.side);
}

std::string seconds_text(double seconds) {
  char text[32];
  if (seconds < 1e-3)
    std::snprintf(text, sizeof text, "%.3g us", seconds * 1e6);
  else if (seconds < 1)
    std::snprintf(text, sizeof text, "%.3g ms", seconds * 1e3);
  else
    std::snprintf(text, sizeof text, "%.3g s", seconds);
  return text;
}

}  // namespace

// Example in space: building a map takes 7e5 ns, the engine 100 ns a point, the pass 5: below 7e5 /
// 95 = 7,368 points a map cannot pay.

// Below this number of points even dropping all of them would save less than the map costs.
std::uint64_t smallest_worth_culling(unsigned d) {
  const Costs& c = costs_of(d);
  return static_cast<std::uint64_t>(c.build / (c.engine_point - c.pass));
}

// The second map drops about half of the survivors and is larger: it costs three or four times the
// first.
std::uint64_t smallest_worth_refining(unsigned d) {
  const Costs& c = costs_of(d);
  return static_cast<std::uint64_t>((d <= 3 ? 4 : 3) * c.build / (c.engine_point - c.pass));
}

// One thread below 2^19 2D points. Medians on two cores, one of them busy with other work: a disk
// of 100,000 points took 541 us with two threads, 415 with one (both idle: 386 and 392), nearly all
// of it in the filter.
unsigned useful_cull_threads(unsigned threads, std::uint64_t count, unsigned d) {
  return d == 2 && count < std::uint64_t{1} << 19 ? 1 : threads;
}

// Likewise, all points extreme: 10,000 points took 438 us with two threads, 271 with one; 50,000
// 3.9 and 1.5 ms; 100,000 took the same (idle: two thirds of it).
unsigned useful_threads(unsigned threads, std::uint64_t count, unsigned d) {
  return d == 2 && count < std::uint64_t{1} << 16 ? 1 : threads;
}

// Where all points are extreme, hulling the probe costs its share of the total time, at most 1 /
// 128. Samples of fewer than 8 d points are too small to decide.
std::uint64_t probe_sample_size(std::uint64_t count, unsigned d) {
  const double size = std::min(static_cast<double>(count) / 128, costs_of(d).largest_probe);
  return std::min(count, std::max(static_cast<std::uint64_t>(size), std::uint64_t{8} * d));
}

// Example: 10^6 points in space, a probe of 1,000 of which 130 are extreme: the map keeps 1.05 *
// 0.13 = 14 %. Dropping the others saves 0.86 * 10^6 * 100 ns = 86 ms of the engine, for 5 ms of
// the pass, the sample's hull and 0.7 ms for the map: it pays. With 950 extreme points the map
// keeps 99.8 %, and it does not.

// A larger sample keeps fewer points where the density is smooth, but not where the points are on a
// surface, and the probe cannot distinguish the two: so no decay is assumed. On a surface extreme =
// sample.
bool cull_pays(std::uint64_t count, unsigned d, std::uint64_t sample, std::uint64_t extreme) {
  const Costs& c = costs_of(d);
  const auto n = static_cast<double>(count);
  const double kept = std::min(1.0, c.excess * kept_share(sample, extreme));
  const auto size = static_cast<double>(map_sample_size(count, d, sample, extreme, false));
  return n * (1 - kept) * c.engine_point > n * c.pass + size * c.sample_point + c.build;
}

// A cell of k points has its leader some 1 / k of the shell's thickness below the surface, and
// chords over cells lie below it by a share that goes with the square of their length: L leaders of
// n points lose a L / n + b L^(-2 / (d - 1)), least where L goes with n^((d - 1) / (d + 1)). In 3D
// measured bodies want L to grow faster: 204 leaders for a normal distribution of 10M, of which few
// points are outside, 2,400 for a ball of 8M. In the last map more nodes are worthwhile, since each
// point that it leaves costs the engine's time, but fewer nodes than leaders. In 4D 13,500 nodes
// leave 68,700 points of a ball of 2M in 27 ms and the hull takes 113 ms; 27,000 nodes left 56,000
// in 35 ms, and the hull took 120 ms. In 3D half as many leave 26,000 points of a ball of 8M
// instead of 21,000, and the hull takes 0.96 of the time.
//
// Where a device finds the leaders of all points, only nodes cost the CPU's time: in 4D 0.65 us of
// one thread each, and the engine takes 0.8 us for a point left. Of a 4D ball of 8M 47,000 leaders
// and 33,000 nodes leave 199,000, 74,000 and 55,000 leave 159,000, 125,000 and 85,000 leave
// 132,000. A node of 5D takes 1 us, and a point left much longer than in 4D.
namespace {

struct LeaderRule {
  double factor, exponent, most, last_count, last_most, last_nodes, all_factor;
};
const LeaderRule& leader_rule(unsigned d) {
  static constexpr LeaderRule rules[] = {{0.6, 0.87, 6144, 12, 12288, 0.5, 0.6},
                                         {6, 0.6, 17576, 6, 131072, 0.6, 10},
                                         {3, 0.67, 20000, 8, 65536, 1, 8},
                                         {3, 0.71, 31250, 8, 65536, 1, 3}};
  return rules[std::clamp(d, 3U, 6U) - 3];
}

}  // namespace

LeaderCounts leader_counts_of_all(double outside, unsigned d) {
  const LeaderRule& rule = leader_rule(d);
  const double leaders =
      std::min(rule.all_factor * std::pow(outside, rule.exponent), rule.last_most);
  return {leaders, leaders * rule.last_nodes};
}

LeaderCounts leader_counts(double outside, std::uint64_t tested, unsigned d) {
  const LeaderRule& rule = leader_rule(d);
  if (static_cast<double>(tested) <= outside) {
    const double leaders = std::min(outside / rule.last_count, rule.last_most);
    return {leaders, leaders * rule.last_nodes};
  }
  const double leaders = std::min(rule.factor * std::pow(outside, rule.exponent), rule.most);
  // The long creases of bodies with few facets are worth more nodes: a node takes as long as
  // testing some 40 points.
  const double nodes = d == 3 ? std::min(static_cast<double>(tested) / 2048, rule.most) : 0;
  return {leaders, std::max(leaders, nodes)};
}

unsigned cells_for(double nodes, unsigned d) {
  unsigned cells =
      std::max(2U, static_cast<unsigned>(std::pow(nodes / (2 * d), 1.0 / (d - 1)) + 0.5) - 1);
  // An even number, so that planes of symmetry through the centre, where bodies often have
  // creases, fall on grid lines.
  if (d == 3) cells += cells % 2;
  return cells;
}

bool map_pays(std::uint64_t count, unsigned d, std::uint64_t sample, std::uint64_t extreme) {
  const Costs& c = costs_of(d);
  const auto n = static_cast<double>(count);
  const double kept = std::min(1.0, c.excess * kept_share(sample, extreme));
  return n * (1 - kept) * c.engine_point > n * c.pass + c.build;
}

std::string sample_finding(std::uint64_t sample, std::uint64_t extreme) {
  return std::to_string(extreme) + " of " + std::to_string(sample) + " sampled points are extreme";
}

Rates& assumed_rates() noexcept {
  static Rates rates;
  return rates;
}

// Example: 10^7 points of 24 bytes on the host, 8 threads: reading 240 MB at 40 GB/s takes 6 ms,
// testing 10^7 * 5 ns / 8 another 6.25 ms at the same time: 6.25 ms. A device gets them over a link
// of 50 GB/s in 4.8 ms, but the first call of a process pays 250 ms for the driver: the CPU is
// chosen.

// A pass on the host costs the larger of reading and testing. For a device, a piece of the points
// is copied into pinned memory while the previous one is transferred: again the larger of the two.
// A device that holds the points reads them at no less than half of its copying rate (docs/gpu.md),
// because a copy moves two bytes for one. What follows the pass is assumed to take as long on the
// CPU as on the device, where it was faster for balls and slower for scans.
Placement choose_place(const PlaceQuestion& q, const Rates& rates) {
  const auto n = static_cast<double>(q.count);
  const double bytes = n * static_cast<double>(q.point_bytes);
  const double host_pass = std::max(
      bytes / rates.host_read, n * costs_of(q.dimension).pass * 1e-9 / std::max(1U, q.threads));
  const double link = bytes / rates.link;
  const double start = q.device_started || q.on_device ? 0 : device_start;
  const double host = q.on_device ? link + host_pass : host_pass;
  const double pinned = 2 * std::min(bytes, pinned_piece);
  const double pin = std::max(0.0, pinned - static_cast<double>(q.pinned_bytes)) / pin_rate;
  const double upload = q.on_device ? 0 : pin + std::max(link, bytes / rates.host_copy);
  const double device = start + device_call + upload + bytes / (rates.device_copy / 2);
  Placement p;
  p.device = device < host;
  p.host_reason = std::string("points on the ") + (q.on_device ? "device" : "host") +
                  ": a pass takes about " + seconds_text(host) + " on the CPU";
  p.reason = p.host_reason + ", " + seconds_text(device) + " on a CUDA device";
  return p;
}

// The CPU's search walks over few facets, however many there are, and by cells it compares a few. A
// device tests all of them, in 11 d instructions of a warp for 32 points, or by cells reads about
// eight sectors of 32 bytes a point from its L2 cache, whose rate is taken to be that of copying
// (docs/gpu.md, "Questions about points on a device"). The CPU builds the cells in both cases:
// after some calls for the same hull, one pays for what all of them save.
Answerer choose_answerer(const AskedPoints& points, const Rates& rates) {
  // An H200 issues 0.9 T warp-instructions a second and copies 4.1 TB/s; a device of another rate
  // of copying is taken to have both in this ratio.
  constexpr double instructions_per_byte = 0.9e12 / 4.1e12;
  constexpr double cell_bytes_a_point = 8 * 32;
  constexpr double cell_bytes = 28;  // its offset, mostly one group of facets, some of the normals
  const auto n = static_cast<double>(points.count), cells = static_cast<double>(points.cells);
  const unsigned threads = std::max(1U, points.threads);
  const double transfer = n * (points.question == Question::sides ? 1 : 8) / rates.link;
  const double answers = points.answers_stay ? 0 : transfer;
  const double build =
      points.cells_built ? 0 : 1e-9 * cells * question_costs_of(points.dimension).cell / threads;
  const double infinity = std::numeric_limits<double>::infinity();
  double cpu = infinity, device = infinity, by_cells = infinity;
  if (points.cpu_allowed)
    cpu = n * static_cast<double>(points.point_bytes) / rates.link +
          n * question_seconds(points) / threads + (cpu_has_cells(points) ? build : 0) +
          (points.answers_stay ? transfer : 0);
  if (points.tests > 0)
    device = device_call + answers +
             n * static_cast<double>(points.tests) * 11 * points.dimension / 32 /
                 (rates.device_copy * instructions_per_byte);
  if (points.cells > 0)
    by_cells = device_call + answers + build * n / (n + static_cast<double>(points.asked_before)) +
               cells * cell_bytes / rates.link + n * cell_bytes_a_point / rates.device_copy;
  if (cpu <= std::min(device, by_cells)) return Answerer::cpu;
  return by_cells < device ? Answerer::device_by_cells : Answerer::device;
}

// A smooth density leaves outside an m-sample's hull a share s(m) ~ m^-a, a = 2 / (d + 1) (Renyi
// and Sulanke 1963, Barany 1989). The cost  sample_point m + survivor count s(m)  is least at m^(1
// + a) = a (survivor / sample_point) count s m0^a, where the probe of m0 points gave s. The sample
// is at most an eighth of the points: where the law does not hold, the loss stays small.
std::uint64_t map_sample_size(std::uint64_t count, unsigned d, std::uint64_t sample,
                              std::uint64_t extreme, bool leaders) {
  constexpr double most_led = 1e6;
  const Costs& c = costs_of(d);
  const double a = 2.0 / (d + 1);
  const double ratio = leaders ? c.leads : c.survivor / c.sample_point;
  const double best =
      std::pow(a * ratio * static_cast<double>(count) * kept_share(sample, extreme) *
                   std::pow(static_cast<double>(sample), a),
               1 / (1 + a));
  const double most =
      std::min(leaders ? most_led : c.largest_sample, static_cast<double>(count) / 8);
  const auto size = static_cast<std::uint64_t>(std::min(best, most));
  return std::min(count, std::max(size, sample));
}

}  // namespace cullhull::internal
