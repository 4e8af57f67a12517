#include "reflection/relief/horizon_sweep.h"
#include "common/services/parallel.h"
#include "reflection/relief/bilinear_cell.h"

#include <algorithm>
#include <numbers>
#include <numeric>

namespace kokage {
namespace {

constexpr int kMostStep = 10;          ///< texels of p and q
constexpr int kBeyond = kMostStep + 2; ///< from there on beyond the border, a step does not come back into the tile
constexpr int kMargin = 2 * kMostStep + 4;
constexpr double kTwoPi = 2 * std::numbers::pi;
/// Horizons may miss what is further away than this many times the relief's depth: it could take away 1/150 of the
/// light at most (the square of the elevation), where nothing nearer does.
constexpr double kReach = 12;
constexpr double kMostTiles = 4;          ///< of reach
constexpr std::size_t kLineTexels = 1024; ///< at least, of a line that one thread follows

double apart(double a, double b) {
    const double turn = std::abs(a - b);
    return std::min(turn, kTwoPi - turn);
}

} // namespace

std::vector<HorizonDirection> horizon_directions(const HeightField& field, const ReliefScale& scale, int count) {
    std::vector<HorizonDirection> all;
    for (int p = -kMostStep; p <= kMostStep; ++p)
        for (int q = -kMostStep; q <= kMostStep; ++q)
            if (std::gcd(p, q) == 1) {
                const double azimuth =
                    std::atan2(q * double(scale.tile_m.y) / field.height, p * double(scale.tile_m.x) / field.width);
                all.push_back({p, q, azimuth < 0 ? azimuth + kTwoPi : azimuth, 0});
            }
    std::vector<HorizonDirection> chosen;
    for (int k = 0; k < count; ++k) {
        const double wanted = kTwoPi * k / count, tolerance = kTwoPi / count / 4;
        // The shortest step that is near enough, or else the nearest.
        const auto cost = [&](const HorizonDirection& d) {
            const double error = apart(d.azimuth, wanted);
            return error <= tolerance ? std::abs(d.p) + std::abs(d.q) + error / tolerance / 2 : 100 + error;
        };
        chosen.push_back(
            *std::min_element(all.begin(), all.end(), [&](const auto& a, const auto& b) { return cost(a) < cost(b); }));
    }
    const auto before = [](const auto& a, const auto& b) { return a.azimuth < b.azimuth; };
    std::sort(chosen.begin(), chosen.end(), before);
    chosen.erase(std::unique(chosen.begin(), chosen.end(),
                             [](const auto& a, const auto& b) { return a.p == b.p && a.q == b.q; }),
                 chosen.end());
    for (std::size_t k = 0; k < chosen.size(); ++k) {
        const double next = chosen[(k + 1) % chosen.size()].azimuth,
                     last = chosen[(k + chosen.size() - 1) % chosen.size()].azimuth;
        const auto forward = [](double from, double to) { return to > from ? to - from : to - from + kTwoPi; };
        chosen[k].share = (forward(last, chosen[k].azimuth) + forward(chosen[k].azimuth, next)) / 2 / kTwoPi;
    }
    return chosen;
}

/// A point of the surface along a step, on the border of a cell: between two texels, given as places from the step's
/// first texel.
struct HorizonSweep::Vertex {
    int first, second;
    float part;    ///< of the way from the first to the second
    float along_m; ///< from the step's first texel
};

/// A run of texels, each a step after the other; before them, `before` steps that make the hull.
struct HorizonSweep::Line {
    int x, y; ///< the first texel
    std::size_t before, count;
};

HorizonSweep::HorizonSweep(const HeightField& field, const ReliefScale& scale)
    : field_(field), texel_m_(glm::dvec2(scale.tile_m) / glm::dvec2(field.width, field.height)) {
    const auto [least, most] = std::minmax_element(field.depths.begin(), field.depths.end());
    reach_m_ = std::min(kReach * double(scale.depth_m) * double(*most - *least),
                        kMostTiles* double(std::max(scale.tile_m.x, scale.tile_m.y)));
    stride_ = field.width + 2 * kMargin;
    heights_.resize(std::size_t(stride_) * std::size_t(field.height + 2 * kMargin));
    for (int y = -kMargin; y < field.height + kMargin; ++y)
        for (int x = -kMargin; x < field.width + kMargin; ++x)
            heights_[std::size_t(y + kMargin) * std::size_t(stride_) + std::size_t(x + kMargin)] =
                -scale.depth_m *
                field.depth(texel_index(x, field.width, field.wrap), texel_index(y, field.height, field.wrap));
}

/// From one texel (left out) to the next (the last of them).
std::vector<HorizonSweep::Vertex> HorizonSweep::vertices_of_step(int p, int q) const {
    std::vector<double> parts; // of the step, where it crosses borders of cells
    for (int i = 1; i <= std::abs(p); ++i)
        parts.push_back(double(i) / std::abs(p));
    for (int j = 1; j < std::abs(q) || (p == 0 && j == 1); ++j)
        parts.push_back(double(j) / std::abs(q));
    std::sort(parts.begin(), parts.end());
    const double length_m = glm::length(glm::dvec2(p, q) * texel_m_);
    std::vector<Vertex> vertices;
    for (const double part : parts) {
        const double x = part * p, y = part * q, i = std::floor(x + 1e-9), j = std::floor(y + 1e-9), a = x - i,
                     b = y - j;
        const int place = int(j) * stride_ + int(i);
        vertices.push_back(
            {place, place + (a > b ? 1 : stride_), float(std::clamp(std::max(a, b), 0., 1.)), float(part * length_m)});
    }
    return vertices;
}

std::vector<HorizonSweep::Line> HorizonSweep::lines_of(int p, int q, std::size_t before) const {
    std::vector<Line> lines;
    const int width = field_.width, height = field_.height;
    const std::size_t longest = std::max(kLineTexels, 4 * before);
    std::vector<bool> seen(field_.depths.size());
    const auto place = [&](int x, int y) { return std::size_t(y) * std::size_t(width) + std::size_t(x); };
    for (int y0 = 0; y0 < height; ++y0)
        for (int x0 = 0; x0 < width; ++x0) {
            int x = x0, y = y0;
            if (field_.wrap == HeightWrap::clamp) { // lines begin at the border
                const auto outside = [](int at, int size) { return at < 0 || at >= size; };
                if (!outside(x - p, width) && !outside(y - q, height))
                    continue;
                lines.push_back({x, y, before, 0});
                for (; !outside(x, width) && !outside(y, height); x += p, y += q)
                    ++lines.back().count;
                continue;
            }
            const std::size_t first = lines.size();
            std::size_t steps = 0; // until the line comes back to where it began
            for (; !seen[place(x, y)]; ++steps) {
                seen[place(x, y)] = true;
                if (steps % longest == 0)
                    lines.push_back({x, y, before, 0});
                ++lines.back().count;
                x = texel_index(x + p, width, HeightWrap::repeat);
                y = texel_index(y + q, height, HeightWrap::repeat);
            }
            for (std::size_t k = first; k < lines.size(); ++k)
                lines[k].before = std::min(before, steps);
        }
    return lines;
}

void HorizonSweep::run(const HorizonDirection& direction, std::span<float> tangents) const {
    const int p = -direction.p, q = -direction.q; // lines come from where horizons are looked for
    const std::vector<Vertex> vertices = vertices_of_step(p, q);
    const double step_m = glm::length(glm::dvec2(p, q) * texel_m_);
    const std::vector<Line> lines = lines_of(p, q, std::size_t(std::ceil(reach_m_ / step_m)));
    const int width = field_.width, height = field_.height;
    const bool repeat = field_.wrap == HeightWrap::repeat;
    parallel_blocks(lines.size(), 16, [&](std::size_t begin, std::size_t end) {
        struct Point {
            double along, height;
        };
        std::vector<Point> hull;
        for (std::size_t l = begin; l < end; ++l) {
            const Line& line = lines[l];
            hull.resize((line.before + line.count) * vertices.size() + 1);
            std::size_t top = 0; // hull[top] is the last
            // Beyond a clamped tile, (x, y) stays by its border: what lies there is the border's again.
            long long x = line.x - (long long)(line.before) * p, y = line.y - (long long)(line.before) * q;
            const auto at = [&] {
                const int i = repeat ? texel_index(x, width, field_.wrap)
                                     : int(std::clamp(x, (long long)(-kBeyond), (long long)(width + kBeyond - 1))),
                          j = repeat ? texel_index(y, height, field_.wrap)
                                     : int(std::clamp(y, (long long)(-kBeyond), (long long)(height + kBeyond - 1)));
                return heights_.data() + std::size_t(j + kMargin) * std::size_t(stride_) + std::size_t(i + kMargin);
            };
            const float* texel = at();
            hull[0] = {0, double(*texel)};
            double start = 0;
            const std::size_t steps = line.before + line.count;
            if (line.before == 0)
                tangents[std::size_t(line.y) * std::size_t(width) + std::size_t(line.x)] = 0;
            for (std::size_t k = 1; k < steps; ++k) {
                double tangent = 0;
                for (const Vertex& v : vertices) {
                    const float first = texel[v.first], second = texel[v.second];
                    const Point point{start + double(v.along_m), double(first + v.part * (second - first))};
                    // What lies below the line from the new point to the one before is hidden for ever.
                    while (top > 0 && (hull[top - 1].height - point.height) * (point.along - hull[top].along) >=
                                          (hull[top].height - point.height) * (point.along - hull[top - 1].along))
                        --top;
                    tangent = (hull[top].height - point.height) / (point.along - hull[top].along);
                    hull[++top] = point;
                }
                start += step_m;
                x += p;
                y += q;
                texel = at();
                if (k >= line.before) {
                    const std::size_t column = std::size_t(repeat ? texel_index(x, width, field_.wrap) : x),
                                      row = std::size_t(repeat ? texel_index(y, height, field_.wrap) : y);
                    tangents[row * std::size_t(width) + column] = float(std::max(0., tangent));
                }
            }
        }
    });
}

} // namespace kokage
