#include "reflection/maps/compare_maps.h"

#include "common/directions/sphere_sets.h"
#include "common/environment/lat_long.h"
#include "common/services/error.h"
#include "reflection/maps/lobe_width.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace kokage {
namespace {

/// Of the lobes of one map, those within both ranges (a little rounding apart).
std::vector<double> within(const std::vector<double>& lobes, double least, double most) {
    std::vector<double> kept;
    for (const double lobe : lobes)
        if (lobe >= least * (1 - 1e-6) && lobe <= most * (1 + 1e-6))
            kept.push_back(lobe);
    return kept;
}

std::vector<double> lobes_of_both(const FilteredMap& a, const FilteredMap& b, int count) {
    if (a.kind != b.kind)
        throw InputError("one map holds lobes of " + std::string(lobe_kind_name(a.kind)) + ", the other of " +
                         std::string(lobe_kind_name(b.kind)) + "; compare maps of one kind");
    const double least = std::max(a.least_parameter, b.least_parameter);
    const double most = std::min(a.most_parameter, b.most_parameter);
    std::vector<double> lobes;
    for (const FilteredMap* map : {&b, &a})
        if (lobes.empty() && !map->own_lobes.empty())
            lobes = within(map->own_lobes, least, most);
    if (lobes.empty() && a.own_lobes.empty() && b.own_lobes.empty() && least <= most) {
        const double from = std::log(lobe_width({a.kind, least})), to = std::log(lobe_width({a.kind, most}));
        const int steps = from == to ? 1 : std::max(count, 2);
        for (int i = 0; i < steps; ++i)
            lobes.push_back(i == 0 ? least
                            : i == steps - 1
                                ? most
                                : lobe_of_width(a.kind, std::exp(from + (to - from) * i / (steps - 1))).parameter);
    }
    if (lobes.empty())
        throw InputError("the maps have no lobe in common: one holds " + a.description + ", the other " +
                         b.description);
    return lobes;
}

struct Sums {
    double absolute_255 = 0, absolute = 0, reference = 0;
};

/// Differences at one lobe, and the sums that its means are made of.
Sums add_up(std::span<const glm::vec3> directions, std::span<const glm::vec3> a, std::span<const glm::vec3> b,
            MapDifference& difference) {
    Sums sums;
    for (std::size_t i = 0; i < a.size(); ++i)
        for (int c = 0; c < 3; ++c) {
            sums.reference += std::abs(double(b[i][c]));
            const double absolute = std::abs(double(a[i][c]) - double(b[i][c]));
            sums.absolute += absolute;
            if (absolute > difference.max_absolute) {
                difference.max_absolute = absolute;
                difference.worst_direction = directions[i];
            }
            const double shown = 255 * std::abs(double(std::clamp(a[i][c], 0.f, 1.f) - std::clamp(b[i][c], 0.f, 1.f)));
            sums.absolute_255 += shown;
            difference.max_255 = std::max(difference.max_255, shown);
        }
    const double count = 3 * double(a.size()), floor = 1e-3 * sums.reference / count;
    difference.mean_255 = sums.absolute_255 / count;
    difference.mean_absolute = sums.absolute / count;
    if (!(floor > 0))
        return sums; // black: nothing to be relative to
    difference.mean_relative = sums.absolute / sums.reference;
    difference.max_relative = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        for (int c = 0; c < 3; ++c) {
            const double d = std::abs(double(a[i][c]) - double(b[i][c]));
            const double relative = d / std::max(std::abs(double(b[i][c])), floor);
            if (relative > *difference.max_relative) {
                difference.max_relative = relative;
                difference.worst_direction = directions[i];
            }
        }
    return sums;
}

} // namespace

MapComparison compare_maps(const FilteredMap& a, const FilteredMap& b, int directions, int lobes) {
    const std::vector<double> parameters = lobes_of_both(a, b, lobes);
    std::vector<glm::vec3> around;
    for (const glm::dvec3& direction : fibonacci_sphere(directions).directions)
        around.emplace_back(direction);
    std::vector<glm::vec3> from_a(around.size()), from_b(around.size());
    MapComparison result;
    result.directions = around.size();
    Sums all;
    for (const double parameter : parameters) {
        a.lookup(around, parameter, from_a);
        b.lookup(around, parameter, from_b);
        MapComparison::OfLobe lobe{parameter, {}};
        const Sums sums = add_up(around, from_a, from_b, lobe.difference);
        all.absolute_255 += sums.absolute_255;
        all.absolute += sums.absolute;
        all.reference += sums.reference;
        result.all.max_255 = std::max(result.all.max_255, lobe.difference.max_255);
        const bool worse = lobe.difference.max_relative || result.all.max_relative
                               ? lobe.difference.max_relative > result.all.max_relative
                               : lobe.difference.max_absolute > result.all.max_absolute;
        if (result.lobes.empty() || worse) {
            result.all.max_relative = lobe.difference.max_relative;
            result.all.worst_direction = lobe.difference.worst_direction;
            result.worst_parameter = parameter;
        }
        result.all.max_absolute = std::max(result.all.max_absolute, lobe.difference.max_absolute);
        result.lobes.push_back(lobe);
    }
    const double count = 3 * double(around.size()) * double(parameters.size());
    result.all.mean_255 = all.absolute_255 / count;
    result.all.mean_absolute = all.absolute / count;
    if (result.all.max_relative)
        result.all.mean_relative = all.absolute / all.reference;
    return result;
}

Image lat_long_of_map(const FilteredMap& map, double parameter, int width) {
    Image image(width, std::max(width / 2, 1), 3);
    std::vector<glm::vec3> directions;
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < width; ++x)
            directions.emplace_back(pixel_direction(x, y, width, image.height));
    std::vector<glm::vec3> filtered(directions.size());
    map.lookup(directions, parameter, filtered);
    for (std::size_t i = 0; i < filtered.size(); ++i)
        std::copy_n(&filtered[i].x, 3, image.pixels.begin() + std::ptrdiff_t(3 * i));
    return image;
}

} // namespace kokage
