#include "common/environment/load_environment.h"
#include "common/scene/image_file.h"
#include "common/services/error.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace kokage {
namespace {

constexpr float largest_radiance = 1e32f; ///< sums over the sphere, and luminance, stay finite in float

enum class Fault { none, nan, infinite, negative };

Fault fault_of(float value) {
    if (std::isnan(value))
        return Fault::nan;
    if (value < 0)
        return Fault::negative;
    return value > largest_radiance ? Fault::infinite : Fault::none;
}

std::string place(int x, int y) {
    return "pixel (" + std::to_string(x) + ", " + std::to_string(y) + ")";
}

/// Mean of the good values of one channel on the smallest square ring around a pixel that has any; wraps in u, ends at
/// the poles.
float mean_of_nearest_good(const Image& image, int x, int y, int channel) {
    for (int radius = 1; radius < std::max(image.width, image.height); ++radius) {
        double sum = 0;
        int count = 0;
        for (int dy = -radius; dy <= radius; ++dy) {
            if (y + dy < 0 || y + dy >= image.height)
                continue;
            const int step =
                std::abs(dy) == radius ? 1 : 2 * radius; // whole rows at the ring's top and bottom, else its two sides
            for (int dx = -radius; dx <= radius; dx += step) {
                const int column = (((x + dx) % image.width) + image.width) % image.width;
                const float value = image.at(column, y + dy)[channel];
                if (fault_of(value) == Fault::none) {
                    sum += double(value);
                    ++count;
                }
            }
        }
        if (count > 0)
            return float(sum / count);
    }
    return 0;
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
            report.infinite_pixels += seen[std::size_t(Fault::infinite)];
            report.negative_pixels += seen[std::size_t(Fault::negative)];
        }
    if (bad.empty())
        return;
    report.first_bad_x = bad.front().x;
    report.first_bad_y = bad.front().y;
    if (strict) {
        const float value = image.at(bad.front().x, bad.front().y)[bad.front().channel];
        throw InputError("environment '" + name + "': " + place(bad.front().x, bad.front().y) + " is " +
                         std::to_string(value) + " in channel " + std::to_string(bad.front().channel) + ", " +
                         std::to_string(bad.size()) +
                         " such values in all; mend the image, or leave out --strict to have them repaired");
    }
    std::vector<float> repaired(bad.size());
    for (std::size_t i = 0; i < bad.size(); ++i) {
        const auto c = std::size_t(bad[i].channel);
        if (bad[i].fault == Fault::negative)
            continue; // 0
        if (!any_good[c])
            throw InputError("environment '" + name + "': channel " + std::to_string(c) +
                             " has no finite, non-negative value at all");
        repaired[i] = bad[i].fault == Fault::infinite ? largest[c]
                                                      : mean_of_nearest_good(image, bad[i].x, bad[i].y, bad[i].channel);
    }
    for (std::size_t i = 0; i < bad.size(); ++i)
        image.at(bad[i].x, bad[i].y)[bad[i].channel] = repaired[i];
}

Environment environment_from_image(Image image, const std::string& name, EnvironmentReport& report,
                                   const EnvironmentLoading& loading) {
    report = {};
    if (image.empty() || image.channels < 3)
        throw InputError("environment '" + name + "': the image is empty or has fewer than 3 channels");
    repair_pixels(image, name, loading.strict, report);
    auto add_note = [&](const std::string& note) { report.note += (report.note.empty() ? "" : "; ") + note; };
    if (report.first_bad_x >= 0)
        add_note("repaired pixels: " + std::to_string(report.nan_pixels) + " NaN, " +
                 std::to_string(report.infinite_pixels) + " infinite, " + std::to_string(report.negative_pixels) +
                 " negative, the first is " + place(report.first_bad_x, report.first_bad_y));
    if (image.width != 2 * image.height && image.width > 1)
        add_note("the image is " + std::to_string(image.width) + " x " + std::to_string(image.height) +
                 ", not twice as wide as high; it is stretched over the sphere all the same");
    if (loading.max_width > 0 && image.width > loading.max_width) {
        add_note("reduced from " + std::to_string(image.width) + " to " + std::to_string(loading.max_width) +
                 " columns");
        image = reduce_lat_long(std::move(image), loading.max_width);
    }
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

Environment load_environment(const std::filesystem::path& path, EnvironmentReport& report,
                             const EnvironmentLoading& loading) {
    return environment_from_image(load_image(path, {.channels = 3}), path.string(), report, loading);
}

} // namespace kokage
