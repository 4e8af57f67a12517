#include "reflection/relief/relief_openness.h"
#include "common/services/error.h"
#include "common/services/parallel.h"
#include "common/types.h"
#include "reflection/relief/bilinear_cell.h"
#include "reflection/relief/horizon_sweep.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace kokage {
namespace {

constexpr int kFewestAzimuths = 4, kMostAzimuths = 256;

/// A texel and the four cells around it, as ReliefOpenness orders them.
constexpr std::size_t kCells = 4, kPlaces = kCells + 1;

/// How depth changes from a texel to the next ones, metres a metre, for all texels.
struct EdgeSlopes {
    std::vector<float> u, v; ///< to the right, downwards

    EdgeSlopes(const HeightField& field, const ReliefScale& scale) {
        const glm::vec2 steps = scale.depth_m / scale.tile_m * glm::vec2(field.width, field.height);
        for (int y = 0; y < field.height; ++y)
            for (int x = 0; x < field.width; ++x) {
                const float depth = field.depth(x, y);
                u.push_back((field.depth(texel_index(x + 1, field.width, field.wrap), y) - depth) * steps.x);
                v.push_back((field.depth(x, texel_index(y + 1, field.height, field.wrap)) - depth) * steps.y);
            }
    }
};

/// Slopes at a texel: of its four cells, and their mean.
std::array<glm::vec2, kPlaces> slopes_at(const HeightField& field, const EdgeSlopes& edges, int x, int y) {
    const auto edge = [&](const std::vector<float>& slopes, int column, int row) {
        return slopes[std::size_t(row) * std::size_t(field.width) + std::size_t(column)];
    };
    const bool clamp = field.wrap == HeightWrap::clamp;
    const float right = edge(edges.u, x, y), down = edge(edges.v, x, y),
                left = clamp && x == 0 ? 0 : edge(edges.u, texel_index(x - 1, field.width, field.wrap), y),
                up = clamp && y == 0 ? 0 : edge(edges.v, x, texel_index(y - 1, field.height, field.wrap));
    return {glm::vec2(right, down), glm::vec2(left, down), glm::vec2(right, up), glm::vec2(left, up),
            0.5f * glm::vec2(right + left, down + up)};
}

/// Within 2e-5, for x >= 0.
float arc_tangent(float x) {
    const float y = x > 1 ? 1 / x : x, s = y * y;
    const float angle =
        y * (0.99997726f +
             s * (-0.33262347f + s * (0.19354346f + s * (-0.11643287f + s * (0.05265332f - s * 0.01172120f)))));
    return x > 1 ? float(kPiDouble / 2) - angle : angle;
}

/// Light from one azimuth above a horizon: eq 3's integral over the elevation e from the horizon h up,
/// ∫ (a cos e + n_z sin e) cos e de = a/2 (π/2 - h - sin h cos h) + n_z/2 cos² h, doubled so that a plane under an open
/// sky has 1. `rise` is how steeply the surface rises along the azimuth: the normal is (.., a, n_z) = n_z (.., -rise,
/// 1).
float open_part(float tangent, float rise, float n_z) {
    const float cos_squared = 1 / (1 + tangent * tangent);
    return n_z * (cos_squared - rise * (float(kPiDouble / 2) - arc_tangent(tangent) - tangent * cos_squared));
}

/// Openness of every texel and in its cells, as sums over azimuths.
using Sums = std::vector<std::array<float, kPlaces>>;

void add_azimuth(const HeightField& field, const EdgeSlopes& edges, OpennessNormal normal,
                 const HorizonDirection& direction, std::span<const float> tangents, Sums& sums) {
    const glm::vec2 azimuth(std::cos(direction.azimuth), std::sin(direction.azimuth));
    const float share = float(direction.share);
    parallel_blocks(std::size_t(field.height), 16, [&](std::size_t begin, std::size_t end) {
        for (std::size_t y = begin; y < end; ++y)
            for (int x = 0; x < field.width; ++x) {
                const std::size_t texel = y * std::size_t(field.width) + std::size_t(x);
                const std::array<glm::vec2, kPlaces> slopes = slopes_at(field, edges, x, int(y));
                const auto rise_of = [&](std::size_t k) { return -glm::dot(slopes[k], azimuth); };
                // The cell that the azimuth leads into is steepest where it begins, if it bends down. That counts at
                // the texel's centre alone; what points near it see beyond their own cell is further away.
                const float at_centre =
                    std::max(tangents[texel], rise_of(std::size_t(azimuth.x < 0) + 2 * std::size_t(azimuth.y < 0)));
                for (std::size_t k = 0; k < kPlaces; ++k) {
                    // Within a cell its own surface hides what is lower; about the surface's normal, that is behind.
                    const float rise = rise_of(k);
                    float tangent = k == kCells ? at_centre : std::max(tangents[texel], rise);
                    if (normal == OpennessNormal::surface)
                        tangent = std::max(tangent, rise);
                    sums[texel][k] +=
                        share * (normal == OpennessNormal::plane
                                     ? 1 / (1 + tangent * tangent)
                                     : open_part(tangent, rise, 1 / std::sqrt(1 + glm::dot(slopes[k], slopes[k]))));
                }
            }
    });
}

std::uint8_t as_byte(float openness) {
    return std::uint8_t(std::lround(std::clamp(openness, 0.f, 1.f) * 255));
}

ReliefOpenness as_bytes(const HeightField& field, const Sums& sums) {
    ReliefOpenness openness{field.width, field.height, field.wrap, {}, {}};
    for (const std::array<float, kPlaces>& sum : sums) {
        openness.texels.push_back(as_byte(sum[kCells]));
        openness.corners.push_back({as_byte(sum[0]), as_byte(sum[1]), as_byte(sum[2]), as_byte(sum[3])});
    }
    return openness;
}

} // namespace

float ReliefOpenness::lookup(const glm::vec2& coordinate) const {
    constexpr double kAtCentre = 1e-3;
    const double x = double(coordinate.x) * width - 0.5, y = double(coordinate.y) * height - 0.5;
    const auto place = [&](double column, double row) {
        return std::size_t(texel_index((long long)(row), height, wrap)) * std::size_t(width) +
               std::size_t(texel_index((long long)(column), width, wrap));
    };
    if (std::abs(x - std::round(x)) < kAtCentre && std::abs(y - std::round(y)) < kAtCentre)
        return float(texels[place(std::round(x), std::round(y))]) / 255;
    const double i = std::floor(x), j = std::floor(y);
    const auto corner = [&](int a, int b) {
        return double(corners[place(i + a, j + b)][std::size_t(a + 2 * b)]) / 255;
    };
    return float(
        std::lerp(std::lerp(corner(0, 0), corner(1, 0), x - i), std::lerp(corner(0, 1), corner(1, 1), x - i), y - j));
}

ReliefOpenness horizon_openness(const HeightField& field, const OpennessSettings& settings, Progress& progress) {
    const ReliefScale& scale = settings.scale;
    if (settings.azimuths < kFewestAzimuths || settings.azimuths > kMostAzimuths)
        throw InputError("ambient occlusion: " + std::to_string(settings.azimuths) + " azimuths; give " +
                         std::to_string(kFewestAzimuths) + " to " + std::to_string(kMostAzimuths));
    if (!(scale.depth_m >= 0 && std::isfinite(scale.depth_m) && scale.tile_m.x > 0 && scale.tile_m.y > 0 &&
          std::isfinite(scale.tile_m.x) && std::isfinite(scale.tile_m.y)))
        throw InputError("ambient occlusion: a relief's depth is at least 0 and its tile wider than 0 metres");
    Sums sums(field.depths.size(), {0, 0, 0, 0, 0});
    const auto [least, most] = std::minmax_element(field.depths.begin(), field.depths.end());
    if (scale.depth_m == 0 || *least == *most) {
        sums.assign(field.depths.size(), {1, 1, 1, 1, 1});
        return as_bytes(field, sums);
    }
    const EdgeSlopes edges(field, scale);
    const std::vector<HorizonDirection> directions = horizon_directions(field, scale, settings.azimuths);
    const HorizonSweep sweep(field, scale);
    std::vector<float> tangents(field.depths.size());
    progress.begin("finding horizons of relief", directions.size());
    for (const HorizonDirection& direction : directions) {
        progress.throw_if_stopped();
        sweep.run(direction, tangents);
        add_azimuth(field, edges, settings.normal, direction, tangents, sums);
        progress.advance(1);
    }
    return as_bytes(field, sums);
}

ReliefOpenness depth_map_openness(const HeightField& field, const DepthMaps& maps, OpennessNormal normal,
                                  float same_hit, Progress& progress) {
    const DepthMapSettings& settings = maps.settings();
    if (maps.kind() != DepthMapKind::first_hits)
        throw InputError("ambient occlusion: these depth maps hold lower bounds, not first hits; make them by "
                         "trace_depth_maps");
    struct Direction {
        glm::vec2 slope;    ///< tiles per depth, downwards
        glm::vec3 from_sky; ///< unit vector to the sky
        float solid_angle;
    };
    std::vector<Direction> directions;
    const double ring = kPiDouble / 2 / settings.zeniths;
    for (int map = 0; map < settings.maps(); ++map) {
        const int k = map / settings.azimuths;
        const glm::dvec2 slope = sampling_slope(settings, map);
        // The band around the direction; the last one reaches down to the horizon.
        const double above = std::max(0., (k - 0.5) * ring),
                     below = k + 1 == settings.zeniths ? kPiDouble / 2 : (k + 0.5) * ring;
        directions.push_back({glm::vec2(relief_slope(settings.scale, slope)),
                              glm::vec3(glm::normalize(glm::dvec3(-slope, 1))),
                              float((std::cos(above) - std::cos(below)) / settings.azimuths)});
    }
    Sums sums(field.depths.size());
    const EdgeSlopes edges(field, settings.scale);
    const auto map_texel = [&](float coordinate) {
        return std::min(int((coordinate - std::floor(coordinate)) * float(settings.size)), settings.size - 1);
    };
    progress.begin("summing depth maps", std::size_t(field.height));
    parallel_blocks(std::size_t(field.height), 4, [&](std::size_t begin, std::size_t end) {
        progress.throw_if_stopped();
        for (std::size_t y = begin; y < end; ++y)
            for (int x = 0; x < field.width; ++x) {
                const std::size_t texel = y * std::size_t(field.width) + std::size_t(x);
                const float depth = field.depths[texel];
                const glm::vec2 at((float(x) + 0.5f) / float(field.width), (float(y) + 0.5f) / float(field.height));
                std::array<glm::vec3, kPlaces> normals;
                const std::array<glm::vec2, kPlaces> slopes = slopes_at(field, edges, x, int(y));
                for (std::size_t k = 0; k < kPlaces; ++k)
                    normals[k] =
                        normal == OpennessNormal::plane ? glm::vec3(0, 0, 1) : glm::normalize(glm::vec3(slopes[k], 1));
                std::array<float, kPlaces> open{}, all{};
                for (int map = 0; map < settings.maps(); ++map) {
                    const Direction& d = directions[std::size_t(map)];
                    const glm::vec2 o = at - depth * d.slope;
                    const bool beyond = field.wrap == HeightWrap::clamp && (o.x < 0 || o.x >= 1 || o.y < 0 || o.y >= 1);
                    const bool lit = beyond || maps.depth(map, map_texel(o.x), map_texel(o.y)) >= depth - same_hit;
                    for (std::size_t k = 0; k < kPlaces; ++k) {
                        const float light = std::max(0.f, glm::dot(d.from_sky, normals[k])) * d.solid_angle;
                        all[k] += light;
                        open[k] += lit ? light : 0;
                    }
                }
                // Light from below the plane's horizon, which no map looks at, never comes.
                for (std::size_t k = 0; k < kPlaces; ++k)
                    sums[texel][k] = all[k] > 0 ? open[k] / all[k] * (1 + normals[k].z) / 2 : 0;
            }
        progress.advance(end - begin);
    });
    return as_bytes(field, sums);
}

} // namespace kokage
