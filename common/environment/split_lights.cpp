#include "common/environment/split_lights.h"
#include "common/environment/light_regions.h"
#include "common/services/error.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <queue>

namespace kokage {
namespace {

/// A pixel's share in a light.
struct Piece {
    glm::dvec3 direction;
    glm::dvec3 irradiance;
    double solid_angle;
    double weight() const { return irradiance.r + irradiance.g + irradiance.b; }
};

glm::dvec3 pixel_color(const Image& image, int x, int y) {
    const float* p = image.at(x, y);
    return {p[0], p[1], p[2]};
}

/// Neighbouring pieces in [begin, end) of the array that holds all pieces of a light.
struct Group {
    std::size_t begin, end;
    int axis;        ///< in which it is longest
    double priority; ///< light times extent^2: what merging it would blur
    bool operator<(const Group& other) const {
        return priority != other.priority ? priority < other.priority : begin > other.begin;
    }
};

Group make_group(const std::vector<Piece>& pieces, std::size_t begin, std::size_t end) {
    glm::dvec3 low = pieces[begin].direction, high = low;
    double weight = 0;
    for (std::size_t i = begin; i < end; ++i) {
        low = glm::min(low, pieces[i].direction);
        high = glm::max(high, pieces[i].direction);
        weight += pieces[i].weight();
    }
    const glm::dvec3 extent = high - low;
    const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
    return {begin, end, axis, weight * glm::dot(extent, extent)};
}

/// Sorts a group along its longest axis and returns where half of its light lies on either side.
std::size_t split_at_median(std::vector<Piece>& pieces, const Group& group) {
    const auto first = pieces.begin() + std::ptrdiff_t(group.begin), last = pieces.begin() + std::ptrdiff_t(group.end);
    const auto axis = glm::length_t(group.axis);
    std::stable_sort(first, last,
                     [&](const Piece& a, const Piece& b) { return a.direction[axis] < b.direction[axis]; });
    double total = 0, sum = 0;
    for (auto i = first; i != last; ++i)
        total += i->weight();
    std::size_t middle = group.begin;
    while (middle + 1 < group.end && sum + pieces[middle].weight() <= 0.5 * total)
        sum += pieces[middle++].weight();
    return std::clamp(middle, group.begin + 1, group.end - 1);
}

DistantLight::Texel merge(const std::vector<Piece>& pieces, const Group& group) {
    glm::dvec3 irradiance(0), mean(0);
    double solid_angle = 0;
    for (std::size_t i = group.begin; i < group.end; ++i) {
        irradiance += pieces[i].irradiance;
        mean += pieces[i].weight() * pieces[i].direction;
        solid_angle += pieces[i].solid_angle;
    }
    const double length = glm::length(mean);
    DistantLight::Texel texel;
    texel.direction = glm::vec3(length > 0 ? mean / length : pieces[group.begin].direction);
    texel.irradiance = glm::vec3(irradiance);
    // Solid angle of a cone = 4 pi sin^2(half_angle / 2).
    texel.half_angle = float(2 * std::asin(std::sqrt(std::min(1.0, solid_angle / (4 * kPiDouble)))));
    return texel;
}

DistantLight make_light(std::vector<Piece> pieces, int max_texels) {
    std::priority_queue<Group> groups;
    groups.push(make_group(pieces, 0, pieces.size()));
    std::vector<Group> done;
    while (!groups.empty()) {
        const Group group = groups.top();
        groups.pop();
        if (group.end - group.begin == 1 || groups.size() + done.size() + 1 >= std::size_t(max_texels)) {
            done.push_back(group);
            continue;
        }
        const std::size_t middle = split_at_median(pieces, group);
        groups.push(make_group(pieces, group.begin, middle));
        groups.push(make_group(pieces, middle, group.end));
    }
    std::sort(done.begin(), done.end(), [](const Group& a, const Group& b) { return a.begin < b.begin; });

    DistantLight light;
    const DistantLight::Texel whole = merge(pieces, {0, pieces.size(), 0, 0});
    light.direction = whole.direction;
    light.irradiance = whole.irradiance;
    for (const Group& group : done) {
        light.texels.push_back(merge(pieces, group));
        const DistantLight::Texel& texel = light.texels.back();
        // By the chord: an arc cosine in float is off by 3e-4 for small angles.
        const float apart = 2 * std::asin(std::min(1.f, 0.5f * glm::distance(texel.direction, light.direction)));
        light.half_angle = std::max(light.half_angle, std::min(kPi, apart + texel.half_angle));
    }
    return light;
}

/// What was cut out of an image, as directions and as pixels.
struct Cut {
    std::vector<Piece> pieces;
    std::vector<DistantLight::Pixel> pixels;
};

/// Cuts a region out of the remainder and returns what was cut.
Cut cut_out(Image& remainder, const LightRegion& region, const glm::dvec3& fill) {
    Cut cut;
    for (const PixelRun& run : region.runs) {
        const double solid_angle = pixel_solid_angle(run.y, remainder.width, remainder.height);
        for (int x = run.begin; x < run.end; ++x) {
            // In float, as it will stand in the image: what is left and what is taken then add up to the pixel.
            const glm::dvec3 color = pixel_color(remainder, x, run.y),
                             left(glm::min(glm::vec3(fill), glm::vec3(color)));
            for (int c = 0; c < 3; ++c)
                remainder.at(x, run.y)[c] = float(left[glm::length_t(c)]);
            if (color == left)
                continue;
            cut.pieces.push_back({pixel_direction(x, run.y, remainder.width, remainder.height),
                                  (color - left) * solid_angle, solid_angle});
            cut.pixels.push_back({x, run.y, glm::vec3(color - left)});
        }
    }
    return cut;
}

Image first_three_channels(const Image& image) {
    if (image.channels == 3)
        return image;
    Image rgb(image.width, image.height, 3);
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            std::copy_n(image.at(x, y), 3, rgb.at(x, y));
    return rgb;
}

std::string region_name(std::size_t number, std::size_t count, const glm::vec3& direction) {
    const glm::vec2 uv = lat_long_from_direction(direction);
    char text[80];
    std::snprintf(text, sizeof text, "region %zu of %zu (u %.3f, v %.3f)", number, count, double(uv.x), double(uv.y));
    return text;
}

/// A region that is a light, and the brightness above which its pixels are bright.
struct Found {
    LightRegion region;
    double threshold;
};

/// Rules 1 to 4 of the header.
std::vector<Found> find_lights(const Image& image, const BrightPixels& bright, const LightSplitting& rule) {
    std::vector<Found> lights;
    struct Candidates {
        std::vector<PixelRun> runs;
        double threshold;
    };
    std::vector<Candidates> to_connect{{bright.runs, bright.threshold}};
    while (!to_connect.empty()) {
        const Candidates candidates = std::move(to_connect.back());
        to_connect.pop_back();
        for (LightRegion& region : connect_regions(image, candidates.runs, bright.background, rule.gap_degrees)) {
            if (!(region.excess > 0 && region.excess >= rule.least_share * bright.total))
                continue;
            if (cone_degrees(image, region) <= rule.max_half_angle_degrees) {
                lights.push_back({std::move(region), candidates.threshold});
                continue;
            }
            // At least the dimmest pixel goes: over a black background the threshold is 0, and doubling that leads
            // nowhere.
            const double threshold = std::max(2 * candidates.threshold, least_brightness(image, region));
            to_connect.push_back({brighter_runs(image, region.runs, threshold), threshold});
        }
    }
    std::stable_sort(lights.begin(), lights.end(),
                     [](const Found& a, const Found& b) { return a.region.excess > b.region.excess; });
    return lights;
}

} // namespace

LightSplit split_lights(const Image& image, const LightSplitting& splitting) {
    if (image.empty() || image.channels < 3)
        throw InputError("environment: the image is empty or has fewer than 3 channels");
    LightSplit split;
    split.remainder = first_three_channels(image);
    const BrightPixels bright = find_bright_pixels(split.remainder, splitting.brightness_ratio);
    std::vector<Found> found = find_lights(split.remainder, bright, splitting);
    split.regions_found = found.size();
    found.resize(std::min(found.size(), std::size_t(std::max(splitting.max_lights, 0))));

    std::vector<glm::dvec3> fills; // all before the first cut, so that no fill sees another's
    for (const Found& light : found)
        fills.push_back(surrounding_color(split.remainder, light.region, light.threshold, bright.background_color,
                                          splitting.gap_degrees));
    for (std::size_t i = 0; i < found.size(); ++i) {
        Cut cut = cut_out(split.remainder, found[i].region, fills[i]);
        if (cut.pieces.empty())
            continue;
        split.lights.push_back(make_light(std::move(cut.pieces), std::max(splitting.max_texels, 1)));
        split.lights.back().pixels = std::move(cut.pixels);
    }
    for (std::size_t i = 0; i < split.lights.size(); ++i)
        split.lights[i].name = region_name(i + 1, split.lights.size(), split.lights[i].direction);
    return split;
}

glm::dvec3 radiance_integral(const Image& lat_long) {
    glm::dvec3 sum(0);
    for (int y = 0; y < lat_long.height; ++y) {
        glm::dvec3 row(0);
        for (int x = 0; x < lat_long.width; ++x)
            row += pixel_color(lat_long, x, y);
        sum += pixel_solid_angle(y, lat_long.width, lat_long.height) * row;
    }
    return sum;
}

double luminance_integral(const Image& lat_long) {
    return glm::dot(radiance_integral(lat_long), glm::dvec3(0.2126, 0.7152, 0.0722));
}

} // namespace kokage
