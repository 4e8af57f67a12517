#include "reflection/maps/brute_force_baker.h"

#include "common/directions/lobes.h"
#include "common/environment/lat_long.h"
#include "common/services/error.h"
#include "common/services/parallel.h"
#include "common/services/stopwatch.h"
#include "reflection/maps/lat_long_sums.h"
#include "reflection/maps/lobe_over_cone.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace kokage {
namespace {

constexpr double kLeastShare = 1e-17; ///< of the lobe's peak
/// Below this share of what the pixel at the peak would weigh, weights are taken relative to the nearest pixel's.
constexpr double kThinlySampled = 1e-6;

struct NearestPixel {
    double squared_distance = 5;
    int x = 0, y = 0;
};

NearestPixel nearest_pixel(const LatLongPlanes& planes, const glm::dvec3& direction) {
    NearestPixel nearest;
    const double u = 0.5 + std::atan2(direction.z, direction.x) / (2 * kPiDouble);
    const int x = std::clamp(int(u * planes.width), 0, planes.width - 1);
    for (int y = 0; y < planes.height; ++y) {
        const glm::dvec3 between = planes.direction(x, y) - direction;
        if (const double squared = glm::dot(between, between); squared < nearest.squared_distance)
            nearest = {squared, x, y};
    }
    return nearest;
}

/// The squared distance beyond which the lobe is below `share` of its value at `nearest`.
double reach_beyond(const Lobe& lobe, double nearest, double share) {
    const double w = 0.5 * nearest;
    if (lobe.kind == LobeKind::phong) // (1-w')^L = share (1-w)^L, in logarithms because the powers underflow
        return lobe.parameter > 0 ? -2 * std::expm1(std::log(share) / lobe.parameter + std::log1p(-w)) : 2;
    return lobe_reach(lobe, share * lobe_value(lobe, nearest) / lobe_value(lobe, 0));
}

glm::vec3 as_float(const glm::dvec3& value) {
    return glm::vec3(glm::min(value, glm::dvec3(double(std::numeric_limits<float>::max()))));
}

class BruteForceBaker final : public Baker {
  public:
    BruteForceBaker(const TexelLayout& layout, int width, int height) : layout_(layout), planes_(width, height) {}

    void bake(const Environment& surroundings, std::span<glm::vec3> filtered, WorkReport& report,
              Progress& progress) override {
        const Image& image = surroundings.remainder;
        if (image.width != planes_.width || image.height != planes_.height)
            throw InputError("the image is " + std::to_string(image.width) + "x" + std::to_string(image.height) +
                             " but the baker was made for " + std::to_string(planes_.width) + "x" +
                             std::to_string(planes_.height) + ": make a baker for it");
        const Stopwatch watch;
        planes_.set_pixels(image);
        progress.begin("filtering by brute force", layout_.size());
        parallel_blocks(layout_.size(), 64, [&](std::size_t begin, std::size_t end) {
            progress.throw_if_stopped();
            for (std::size_t i = begin; i < end; ++i)
                filtered[i] = texel(surroundings.distant_lights, i);
            progress.advance(end - begin);
        });
        report.stages.push_back({"filtering by brute force", watch.cpu(), watch.wall()});
        report.counts.push_back({"texels", layout_.size()});
        report.counts.push_back({"pixels", std::uint64_t(image.width) * std::uint64_t(image.height)});
        report.counts.push_back({"lights", surroundings.distant_lights.size()});
    }

  private:
    glm::vec3 texel(std::span<const DistantLight> lights, std::size_t i) const {
        const Lobe lobe{layout_.kind, double(layout_.parameters[i])};
        const glm::dvec3 direction = glm::normalize(glm::dvec3(layout_.directions[i]));
        glm::dvec3 radiance = filtered_image(planes_, lobe, direction, kLeastShare);
        for (const DistantLight& light : lights)
            radiance += light_through_lobe(light, lobe, direction);
        return as_float(radiance);
    }

    TexelLayout layout_;
    LatLongPlanes planes_;
};

} // namespace

glm::dvec3 filtered_image(const LatLongPlanes& planes, const Lobe& lobe, const glm::dvec3& direction,
                          double least_share) {
    const double largest_pixel = planes.row_angle[planes.row_angle.size() / 2];
    const LobeSums sums = sum_over_lobe(planes, lobe, direction, lobe_reach(lobe, least_share), 0);
    if (sums.weight > kThinlySampled * largest_pixel)
        return sums.radiance / sums.weight;
    const NearestPixel nearest = nearest_pixel(planes, direction);
    if (nearest.squared_distance >= 2)
        return planes.pixel(nearest.x, nearest.y);
    const LobeSums relative = sum_over_lobe(
        planes, lobe, direction, reach_beyond(lobe, nearest.squared_distance, least_share), nearest.squared_distance);
    return relative.radiance / relative.weight;
}

std::unique_ptr<Baker> brute_force_baker(const TexelLayout& layout, int image_width, int image_height) {
    return std::make_unique<BruteForceBaker>(layout, image_width, image_height);
}

glm::dvec3 filtered_by_brute_force(const Environment& surroundings, const Lobe& lobe, const glm::dvec3& direction) {
    const Image& image = surroundings.remainder;
    const auto squared_distance = [&](int x, int y) {
        const glm::dvec3 between = pixel_direction(x, y, image.width, image.height) - direction;
        return glm::dot(between, between);
    };
    const auto pixel = [&](int x, int y) {
        return glm::dvec3(image.at(x, y)[0], image.at(x, y)[1], image.at(x, y)[2]);
    };
    NearestPixel nearest;
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            if (const double squared = squared_distance(x, y); squared < nearest.squared_distance)
                nearest = {squared, x, y};
    glm::dvec3 radiance = pixel(nearest.x, nearest.y);
    if (nearest.squared_distance < 2) {
        // In logarithms, relative to the nearest pixel's: no weight overflows, and never all of them underflow.
        const auto log_weight = [&](double squared) {
            const double w = 0.5 * squared;
            if (lobe.kind == LobeKind::phong)
                return lobe.parameter == 0 ? 0 : lobe.parameter * std::log1p(-w);
            return std::log1p(-w) - 2 * std::log1p(ggx_falloff(lobe.parameter) * w);
        };
        const double most = log_weight(nearest.squared_distance);
        glm::dvec3 sum(0.0);
        double weights = 0;
        for (int y = 0; y < image.height; ++y)
            for (int x = 0; x < image.width; ++x) {
                const double squared = squared_distance(x, y);
                if (squared >= 2)
                    continue;
                const double weight =
                    std::exp(log_weight(squared) - most) * pixel_solid_angle(y, image.width, image.height);
                sum += weight * pixel(x, y);
                weights += weight;
            }
        radiance = sum / weights;
    }
    for (const DistantLight& light : surroundings.distant_lights)
        radiance += light_through_lobe(light, lobe, direction);
    return radiance;
}

} // namespace kokage
