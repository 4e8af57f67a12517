#include "common/environment/load_environment.h"
#include "common/scene/image_file.h"
#include "common/services/count_text.h"
#include "common/services/error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace kokage {
namespace {

constexpr float largest_radiance = 1e32f; ///< sums over the sphere, and luminance, stay finite in float

enum class Fault { none, nan, too_large, negative }; ///< too large: infinite ones, too

Fault fault_of(float value) {
    if (std::isnan(value))
        return Fault::nan;
    if (value < 0)
        return Fault::negative;
    return value > largest_radiance ? Fault::too_large : Fault::none;
}

std::string place(int x, int y) {
    return "pixel (" + std::to_string(x) + ", " + std::to_string(y) + ")";
}

/// One channel's bad values of a kind, filled layer by layer: a pixel next to good ones (8 neighbours, wrapping in u)
/// takes their mean and counts as good for the next layer.
void fill_inwards(Image& image, int channel, std::vector<std::pair<int, int>> holes) {
    std::vector<bool> is_hole(std::size_t(image.width) * std::size_t(image.height));
    auto hole = [&](int x, int y) { return is_hole[std::size_t(y) * std::size_t(image.width) + std::size_t(x)]; };
    for (const auto& [x, y] : holes)
        is_hole[std::size_t(y) * std::size_t(image.width) + std::size_t(x)] = true;
    auto for_neighbours = [&](int x, int y, auto&& visit) {
        for (int dy = -1; dy <= 1; ++dy)
            for (int dx = -1; dx <= 1; ++dx)
                if (const int nx = (x + dx + image.width) % image.width, ny = y + dy;
                    ny >= 0 && ny < image.height && (dx != 0 || dy != 0))
                    visit(nx, ny);
    };
    // Holes in reach of the last layer; at first all of them.
    while (!holes.empty()) {
        std::vector<std::pair<std::pair<int, int>, float>> layer;
        for (const auto& [x, y] : holes) {
            double sum = 0;
            int count = 0;
            if (hole(x, y))
                for_neighbours(x, y, [&](int nx, int ny) {
                    if (!hole(nx, ny)) {
                        sum += double(image.at(nx, ny)[channel]);
                        ++count;
                    }
                });
            if (count > 0)
                layer.push_back({{x, y}, float(sum / count)});
        }
        holes.clear();
        for (const auto& [at, value] : layer) {
            image.at(at.first, at.second)[channel] = value;
            is_hole[std::size_t(at.second) * std::size_t(image.width) + std::size_t(at.first)] = false;
        }
        for (const auto& [at, value] : layer)
            for_neighbours(at.first, at.second, [&](int nx, int ny) {
                if (hole(nx, ny))
                    holes.emplace_back(nx, ny);
            });
        std::sort(holes.begin(), holes.end());
        holes.erase(std::unique(holes.begin(), holes.end()), holes.end());
    }
}

/// A lat-long image spans 360 x 180 degrees. Empty if the shape fits. Throws for what can't be one.
std::string shape_warning(const Image& image, const std::string& name) {
    if (image.width == 2 * image.height || image.width == 1) // one column: the same all around
        return "";
    const std::string size = std::to_string(image.width) + " x " + std::to_string(image.height);
    if (image.height > image.width)
        throw InputError("environment '" + name + "': its " + size +
                         " pixels are higher than wide; a lat-long image shows 360 x 180 degrees and is twice as wide "
                         "as high, so convert it to that first");
    return "'" + name + "' is " + size + ", not twice as wide as high as a lat-long image is; it is stretched over " +
           "the whole sphere all the same" +
           (image.width == image.height ? " (a mirror ball or an angular map has to be converted first)" : "");
}

/// Columns move to the left where the scene is turned from +Z towards +X: u = 0.5 + atan2(z, x)/2π falls.
void turn(Image& image, double degrees) {
    const double columns = std::remainder(degrees, 360.) / 360 * image.width;
    const auto shift = (std::lround(columns) % image.width + image.width) % image.width;
    for (int y = 0; y < image.height; ++y)
        std::rotate(image.at(0, y), image.at(int(shift), y), image.at(0, y) + image.width * image.channels);
}

} // namespace

void repair_pixels(Image& image, const std::string& name, bool strict, EnvironmentReport& report) {
    struct BadValue {
        int x, y, channel;
        Fault fault;
    };
    std::vector<BadValue> bad;
    std::array<float, 3> largest{};
    std::array<bool, 3> any_good{};
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            std::array<bool, 4> seen{};
            for (int c = 0; c < 3; ++c) {
                const float value = image.at(x, y)[c];
                const Fault fault = fault_of(value);
                if (fault == Fault::none) {
                    any_good[std::size_t(c)] = true;
                    largest[std::size_t(c)] = std::max(largest[std::size_t(c)], value);
                    continue;
                }
                bad.push_back({x, y, c, fault});
                seen[std::size_t(fault)] = true;
            }
            report.nan_pixels += seen[std::size_t(Fault::nan)];
            report.infinite_pixels += seen[std::size_t(Fault::too_large)];
            report.negative_pixels += seen[std::size_t(Fault::negative)];
        }
    if (bad.empty())
        return;
    report.first_bad_x = bad.front().x;
    report.first_bad_y = bad.front().y;
    if (strict) {
        char value[64];
        std::snprintf(value, sizeof value, bad.front().fault == Fault::too_large ? "%g (too large, above 1e32)" : "%g",
                      double(image.at(bad.front().x, bad.front().y)[bad.front().channel]));
        throw InputError("environment '" + name + "': " + place(bad.front().x, bad.front().y) + " is " + value +
                         " in channel " + std::to_string(bad.front().channel) + ", " +
                         counted(bad.size(), "such value", "such values") +
                         " in all; mend the image, or have them repaired by leaving out strict reading");
    }
    std::array<std::vector<std::pair<int, int>>, 3> holes;
    for (const BadValue& value : bad) {
        const auto c = std::size_t(value.channel);
        if (value.fault != Fault::negative && !any_good[c])
            throw InputError("environment '" + name + "': channel " + std::to_string(c) +
                             " has no value from 0 to 1e32 at all; give an image of radiance");
        if (value.fault == Fault::nan)
            holes[c].emplace_back(value.x, value.y);
        else
            image.at(value.x, value.y)[value.channel] = value.fault == Fault::too_large ? largest[c] : 0.f;
    }
    for (int c = 0; c < 3; ++c)
        fill_inwards(image, c, std::move(holes[std::size_t(c)]));
}

Environment environment_from_image(Image image, const std::string& name, EnvironmentReport& report,
                                   const EnvironmentLoading& loading) {
    report = {};
    if (image.empty() || image.channels < 3)
        throw InputError("environment '" + name + "': the image is empty or has fewer than 3 channels");
    const std::string shape = shape_warning(image, name);
    repair_pixels(image, name, loading.strict, report);
    auto add_note = [&](const std::string& note) { report.note += (report.note.empty() ? "" : "; ") + note; };
    auto add_warning = [&](const std::string& warning) {
        add_note(warning);
        report.warnings.push_back(warning);
    };
    if (report.first_bad_x >= 0)
        add_warning("'" + name + "' has bad pixels, which were repaired: " + std::to_string(report.nan_pixels) +
                    " NaN, " + std::to_string(report.infinite_pixels) + " infinite or too large (above 1e32), " +
                    std::to_string(report.negative_pixels) + " negative; the first is " +
                    place(report.first_bad_x, report.first_bad_y));
    if (!shape.empty())
        add_warning(shape);
    if (loading.max_width > 0 && image.width > loading.max_width) {
        report.columns_before_reduction = image.width;
        add_note("reduced from " + std::to_string(image.width) + " to " + std::to_string(loading.max_width) +
                 " columns");
        image = reduce_lat_long(std::move(image), loading.max_width);
    }
    if (loading.turn_degrees != 0 && std::isfinite(loading.turn_degrees))
        turn(image, loading.turn_degrees);
    report.energy_before = luminance_integral(image);

    Environment environment;
    environment.description = name + " (" + std::to_string(image.width) + " x " + std::to_string(image.height) + ")";
    if (loading.split) {
        LightSplit split = split_lights(image, loading.splitting);
        environment.remainder = std::move(split.remainder);
        environment.distant_lights = std::move(split.lights);
        report.regions_found = split.regions_found;
        if (split.regions_found > environment.distant_lights.size())
            add_note(std::to_string(split.regions_found) + " bright regions, of which the brightest " +
                     std::to_string(environment.distant_lights.size()) + " became lights");
    } else {
        environment.remainder = std::move(image);
    }
    report.energy_after = luminance_integral(environment.remainder);
    for (const DistantLight& light : environment.distant_lights)
        report.energy_after += glm::dot(glm::dvec3(light.irradiance), glm::dvec3(0.2126, 0.7152, 0.0722));
    return environment;
}

std::optional<WorkReport::Skip> skipped_by_reduction(const EnvironmentReport& report, const Environment& environment) {
    if (report.columns_before_reduction == 0)
        return std::nullopt;
    return WorkReport::Skip{"finer pixels of the image", "so wide images are reduced",
                            std::to_string(report.columns_before_reduction) + " columns became " +
                                std::to_string(environment.remainder.width)};
}

Environment load_environment(const std::filesystem::path& path, EnvironmentReport& report,
                             const EnvironmentLoading& loading) {
    return environment_from_image(load_image(path, {.channels = 3}), path.string(), report, loading);
}

} // namespace kokage
