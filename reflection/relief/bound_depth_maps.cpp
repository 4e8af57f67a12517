// Lower bounds of depth for whole cells of points O and directions.
//
// At depth z all rays of a cell stand in a rectangle that moves and grows with z. As long as the least depth below the
// rectangle is more than z, none of them can have hit: so z is stepped down until that can no longer be said.
#include "common/services/parallel.h"
#include "reflection/relief/depth_maps.h"
#include "reflection/relief/least_depths.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace kokage {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kAngleMargin = 1e-4;  ///< radians: a ray's cell is found in single precision
constexpr double kOriginMargin = 1e-5; ///< tiles
constexpr double kDepthStep = 1. / 512;
constexpr double kSlopeStep = 0.15;         ///< tiles per depth: about how long slope rectangles are
constexpr double kSectorStep = 6 * kDegree; ///< and how wide
constexpr int kCoarsest = 4;                ///< texels: bounds of larger blocks start those of their parts

struct Rectangle {
    double u0, u1, v0, v1;
};

/// Around the slopes of a sector of a ring.
Rectangle sector_slopes(const ReliefScale& scale, double azimuth0, double azimuth1, double tangent0, double tangent1) {
    Rectangle box{1e30, -1e30, 1e30, -1e30};
    const auto take = [&](double azimuth) {
        for (const double tangent : {tangent0, tangent1}) {
            const glm::dvec2 slope = relief_slope(scale, tangent * glm::dvec2(std::cos(azimuth), std::sin(azimuth)));
            box = {std::min(box.u0, slope.x), std::max(box.u1, slope.x), std::min(box.v0, slope.y),
                   std::max(box.v1, slope.y)};
        }
    };
    take(azimuth0);
    take(azimuth1);
    const double quarter = std::numbers::pi / 2;
    for (double axis = std::ceil(azimuth0 / quarter) * quarter; axis < azimuth1; axis += quarter)
        take(axis);
    return box;
}

/// Rectangles that together hold all slopes of a direction's cell.
std::vector<Rectangle> cell_slopes(const DepthMapSettings& settings, int map) {
    const double ring = std::numbers::pi / 2 / settings.zeniths, sector = 2 * std::numbers::pi / settings.azimuths;
    const double azimuth0 = (map % settings.azimuths - 0.5) * sector - kAngleMargin,
                 azimuth1 = azimuth0 + sector + 2 * kAngleMargin;
    const double last = kLastBoundedZenith * kDegree;
    const double zenith0 = std::max(0., map / settings.azimuths * ring - kAngleMargin),
                 zenith1 = std::min(last + kAngleMargin, (map / settings.azimuths + 1) * ring + kAngleMargin);
    if (zenith0 >= zenith1)
        return {};
    const double tangent0 = std::tan(zenith0), tangent1 = std::tan(zenith1);
    const double reach = glm::length(relief_slope(settings.scale, glm::dvec2(tangent1 - tangent0)));
    const int tangents = std::clamp(int(std::ceil(reach / kSlopeStep)), 2, 12),
              sectors = std::max(2, int(std::ceil(sector / kSectorStep)));
    std::vector<Rectangle> rectangles;
    for (int a = 0; a < sectors; ++a)
        for (int k = 0; k < tangents; ++k)
            rectangles.push_back(sector_slopes(settings.scale, std::lerp(azimuth0, azimuth1, double(a) / sectors),
                                               std::lerp(azimuth0, azimuth1, double(a + 1) / sectors),
                                               std::lerp(tangent0, tangent1, double(k) / tangents),
                                               std::lerp(tangent0, tangent1, double(k + 1) / tangents)));
    return rectangles;
}

/// The least depth of the bilinear surface below where the rays are between depths z0 and z1.
double least_below(const LeastDepths& depths, const HeightField& field, const Rectangle& origins,
                   const Rectangle& slopes, double z0, double z1) {
    const auto texel = [](double coordinate, int size) { return (long long)(std::floor(coordinate * size - 0.5)); };
    return double(depths.least(texel(origins.u0 + std::min(z0 * slopes.u0, z1 * slopes.u0), field.width),
                               texel(origins.u1 + std::max(z0 * slopes.u1, z1 * slopes.u1), field.width) + 1,
                               texel(origins.v0 + std::min(z0 * slopes.v0, z1 * slopes.v0), field.height),
                               texel(origins.v1 + std::max(z0 * slopes.v1, z1 * slopes.v1), field.height) + 1));
}

/// How deep all rays of the rectangles get without a hit, if that is less than `most`; they get to `z` for sure.
double safe_depth(const LeastDepths& depths, const HeightField& field, const Rectangle& origins,
                  const Rectangle& slopes, double z, double most) {
    double step = 1. / 16;
    while (z < most) {
        const double next = std::min(z + step, most), least = least_below(depths, field, origins, slopes, z, next);
        if (least >= next) {
            z = next;
            step *= 2;
        } else if (least > z + kDepthStep) {
            z = least; // up to there the rays are in a part of that rectangle
        } else if (step > kDepthStep) {
            step /= 2;
        } else {
            return std::max(z, std::min(least, next));
        }
    }
    return most;
}

/// Bounds for all texels of a map of `size`, from those of a coarser one of half the size (or none).
std::vector<float> bounds(const LeastDepths& depths, const HeightField& field, const std::vector<Rectangle>& directions,
                          int size, const std::vector<float>& coarser) {
    const std::size_t wide = std::size_t(size);
    std::vector<float> map(wide * wide);
    for (std::size_t y = 0; y < wide; ++y)
        for (std::size_t x = 0; x < wide; ++x) {
            const double start = coarser.empty() ? 0. : double(coarser[y / 2 * (wide / 2) + x / 2]);
            const Rectangle origins{double(x) / size - kOriginMargin, double(x + 1) / size + kOriginMargin,
                                    double(y) / size - kOriginMargin, double(y + 1) / size + kOriginMargin};
            double safe = 1;
            for (const Rectangle& slopes : directions)
                safe = safe_depth(depths, field, origins, slopes, start, safe);
            map[y * wide + x] = float(safe);
        }
    return map;
}

} // namespace

DepthMaps bound_depth_maps(const HeightField& field, const DepthMapSettings& settings, Progress& progress) {
    settings.check();
    const LeastDepths least(field);
    const std::size_t texels = std::size_t(settings.size) * std::size_t(settings.size);
    LargeVector<std::uint8_t> stored(texels * std::size_t(settings.maps()));
    progress.begin("bounding depth maps", std::size_t(settings.maps()));
    parallel_blocks(std::size_t(settings.maps()), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t map = begin; map < end; ++map) {
            progress.throw_if_stopped();
            const std::vector<Rectangle> directions = cell_slopes(settings, int(map));
            std::vector<int> sizes{settings.size};
            while (sizes.back() % 2 == 0 && sizes.back() / 2 >= kCoarsest)
                sizes.push_back(sizes.back() / 2);
            std::vector<float> bound;
            for (auto size = sizes.rbegin(); size != sizes.rend(); ++size)
                bound = bounds(least, field, directions, *size, bound);
            // A direction beyond the last that is bounded keeps depth 0.
            std::transform(bound.begin(), bound.end(), stored.begin() + std::ptrdiff_t(map * texels),
                           [&](float depth) { return std::uint8_t(directions.empty() ? 0.f : depth * 255.f); });
            progress.advance(1);
        }
    });
    return DepthMaps(DepthMapKind::lower_bounds, settings, std::move(stored));
}

} // namespace kokage
