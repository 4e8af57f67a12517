#include "reflection/maps/spectral_baker.h"
#include "common/environment/split_lights.h"
#include "common/services/error.h"
#include "common/services/parallel.h"
#include "common/services/stopwatch.h"
#include "reflection/maps/brute_force_baker.h"
#include "reflection/maps/lobe_lights.h"
#include "reflection/maps/shell_map.h"
#include "reflection/maps/spectral_plan.h"
#include "reflection/maps/spectral_read.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>

namespace kokage {
namespace {

constexpr std::size_t kReadBlock = 4096;

std::string text(const char* format, double value) {
    char buffer[64];
    std::snprintf(buffer, sizeof buffer, format, value);
    return buffer;
}

struct Range {
    glm::vec3 least, most;
};

/// Per channel; throws if a pixel is negative or no number.
Range range_of(const Image& image) {
    Range range{glm::vec3(std::numeric_limits<float>::max()), glm::vec3(0)};
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            const float* p = image.at(x, y);
            const glm::vec3 pixel(p[0], p[1], p[2]);
            if (!(pixel.r >= 0 && pixel.g >= 0 && pixel.b >= 0 && std::isfinite(pixel.r + pixel.g + pixel.b)))
                throw InputError("baking: the pixel at " + std::to_string(x) + ", " + std::to_string(y) +
                                 " is negative or not a finite number: repair the image first");
            range.least = glm::min(range.least, pixel);
            range.most = glm::max(range.most, pixel);
        }
    return range;
}

float largest(const glm::vec3& v) {
    return std::max({v.r, v.g, v.b});
}

/// A power of two that brings `most` to between 1/2 and 1, so that no sum overflows and scaling loses nothing.
float scale_to_one(float most) {
    return most > 0 ? float(std::ldexp(1.0, std::clamp(-std::ilogb(most) - 1, -126, 126))) : 1.f;
}

class SpectralBaker final : public Baker {
  public:
    SpectralBaker(const TexelLayout& layout, int width, int height, const SpectralSettings& settings,
                  WorkReport& report, Progress& progress);
    void bake(const Environment& surroundings, std::span<glm::vec3> filtered, WorkReport& report,
              Progress& progress) override;

  private:
    void place_texels();
    void normalize();
    void filter_smooth(const Image& image, float most, std::span<glm::vec3> filtered, WorkReport& report,
                       Progress& progress);
    void add_lights(const Image& image, std::span<const ClusterOfLight> in_image, std::span<const DistantLight> others,
                    std::span<glm::vec3> filtered, WorkReport& report);
    void filter_direct(const Image& image, std::span<glm::vec3> filtered, WorkReport& report);

    TexelLayout layout_;
    int width_, height_;
    SpectralSettings settings_;
    SpectralPlan plan_;
    std::vector<TexelPlace> places_;
    std::vector<std::uint32_t> direct_; ///< texels that are summed pixel by pixel
    std::optional<RingAnalysis> analysis_;
    /// Neighbouring shells with grids of one size.
    struct ShellGroup {
        std::size_t first, count;
        RingSynthesis synthesis;
    };
    std::vector<ShellGroup> groups_;
    std::vector<std::vector<double>> zonals_; ///< of each shell
    std::vector<RingGrid> grids_;             ///< of each shell
    LobeLights lights_;
    std::vector<float> factors_; ///< of each texel: 1 over the sum of its weights, 0 where it is summed pixel by pixel
    double least_spread_ = 1;
};

SpectralBaker::SpectralBaker(const TexelLayout& layout, int width, int height, const SpectralSettings& settings,
                             WorkReport& report, Progress& progress)
    : layout_(layout), width_(width), height_(height), settings_(settings),
      plan_(layout, width, height, settings.tolerance), lights_(layout_) {
    const Stopwatch watch;
    progress.begin("preparing harmonics", plan_.shells().size() + 1);
    if (!plan_.shells().empty())
        analysis_.emplace(width, height, plan_.bands());
    progress.advance(1);
    std::size_t bytes = analysis_ ? analysis_->bytes() : 0;
    const std::vector<SpectralShell>& shells = plan_.shells();
    for (std::size_t begin = 0, end = 0; begin < shells.size(); begin = end) {
        progress.throw_if_stopped();
        std::size_t bands = 0;
        for (;
             end < shells.size() && end - begin < RingSynthesis::kMostGrids && shells[end].rings == shells[begin].rings;
             ++end) {
            bands = std::max(bands, shells[end].zonal.size());
            zonals_.push_back(shells[end].zonal);
            grids_.emplace_back(shells[end].rings, 2 * shells[end].rings);
            bytes += grids_.back().cells.size() * sizeof(glm::vec4);
        }
        groups_.push_back(
            {begin, end - begin, RingSynthesis(int(bands), shells[begin].rings, 2 * shells[begin].rings)});
        bytes += groups_.back().synthesis.bytes();
        progress.advance(end - begin);
    }
    place_texels();
    normalize();
    bytes += lights_.bytes() + places_.size() * sizeof(TexelPlace) + direct_.size() * sizeof(std::uint32_t);
    report.stages.push_back({"preparing harmonics", watch.cpu(), watch.wall()});
    report.counts.push_back({"bands", std::uint64_t(plan_.shells().empty() ? 0 : plan_.bands())});
    report.counts.push_back({"spectral shells", plan_.shells().size()});
    report.counts.push_back({"texels summed pixel by pixel", direct_.size()});
    report.counts.push_back({"prepared bytes", bytes});
}

void SpectralBaker::place_texels() {
    std::vector<std::uint32_t> spectral;
    for (std::size_t i = 0; i < layout_.size(); ++i) {
        (plan_.is_direct(layout_.parameters[i]) ? direct_ : spectral).push_back(std::uint32_t(i));
        least_spread_ = std::min(least_spread_, lobe_spread({layout_.kind, double(layout_.parameters[i])}));
    }
    places_.resize(spectral.size());
    parallel_blocks(spectral.size(), kReadBlock, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            places_[i] =
                texel_place(layout_.directions[spectral[i]], plan_.mix(layout_.parameters[spectral[i]]), spectral[i]);
    });
}

/// The sum over pixels is divided by the sum of their weights ([R] eq 9), which is 1 but near the poles, where a row of
/// pixels stands for a whole cap, and where pixels are coarse: the same bake of a white image.
void SpectralBaker::normalize() {
    if (places_.empty())
        return;
    Image white(width_, height_, 3);
    std::fill(white.pixels.begin(), white.pixels.end(), 1.f);
    std::vector<glm::vec3> sums(layout_.size());
    WorkReport unused;
    filter_smooth(white, 1, sums, unused, silent_progress());
    factors_.assign(layout_.size(), 0.f);
    for (TexelPlace& place : places_) {
        factors_[place.texel] = 1 / sums[place.texel].g;
        for (float& weight : place.weights)
            weight *= factors_[place.texel];
    }
}

void SpectralBaker::filter_smooth(const Image& image, float most, std::span<glm::vec3> filtered, WorkReport& report,
                                  Progress& progress) {
    if (places_.empty())
        return;
    Stopwatch watch;
    const float scale = scale_to_one(most);
    RingCoefficients coefficients(plan_.bands());
    analysis_->transform(image, scale, coefficients);
    report.stages.push_back({"harmonics of the image", watch.cpu(), watch.wall()});
    watch.restart();
    for (const ShellGroup& group : groups_) {
        progress.throw_if_stopped();
        group.synthesis.transform(coefficients, std::span(zonals_).subspan(group.first, group.count), 1,
                                  std::span(grids_).subspan(group.first, group.count));
    }
    report.stages.push_back({"filtering on rings", watch.cpu(), watch.wall()});
    watch.restart();
    std::vector<float> least((places_.size() + kReadBlock - 1) / kReadBlock);
    parallel_blocks(places_.size(), kReadBlock, [&](std::size_t begin, std::size_t end) {
        least[begin / kReadBlock] = read_texels(std::span(places_).subspan(begin, end - begin), grids_,
                                                plan_.shells_a_texel(), 1 / scale, filtered);
    });
    report.stages.push_back({"reading at the texels", watch.cpu(), watch.wall()});
    const float lowest = *std::min_element(least.begin(), least.end());
    if (lowest < -10 * float(settings_.tolerance))
        report.warnings.push_back("filtered light fell to " + text("%.1e", double(lowest)) +
                                  " of the image's brightest remainder and was set to 0: ask for a smaller tolerance");
}

void SpectralBaker::filter_direct(const Image& image, std::span<glm::vec3> filtered, WorkReport& report) {
    if (direct_.empty())
        return;
    const Stopwatch watch;
    LatLongPlanes planes(width_, height_);
    planes.set_pixels(image);
    parallel_blocks(direct_.size(), 64, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const std::uint32_t texel = direct_[i];
            filtered[texel] = glm::vec3(filtered_image(planes, {layout_.kind, double(layout_.parameters[texel])},
                                                       glm::normalize(glm::dvec3(layout_.directions[texel])), 1e-9));
        }
    });
    report.stages.push_back({"summing pixel by pixel", watch.cpu(), watch.wall()});
}

void SpectralBaker::add_lights(const Image& image, std::span<const ClusterOfLight> in_image,
                               std::span<const DistantLight> others, std::span<glm::vec3> filtered,
                               WorkReport& report) {
    if (in_image.empty() && others.empty())
        return;
    const Stopwatch watch;
    std::vector<ClusterOfLight> clusters;
    for (const DistantLight& light : others)
        clusters.push_back(cluster_of(light, least_spread_));
    const double mean = luminance_integral(image) / (4 * kPiDouble);
    const float negligible = float(1e-2 * settings_.tolerance * mean);
    std::uint64_t lobes = 0;
    if (!places_.empty())
        lobes += lights_.add(in_image, negligible, factors_, filtered);
    lobes += lights_.add(clusters, negligible, {}, filtered);
    report.counts.push_back({"lobes of lights", lobes});
    report.stages.push_back({"lobes of lights", watch.cpu(), watch.wall()});
}

void SpectralBaker::bake(const Environment& surroundings, std::span<glm::vec3> filtered, WorkReport& report,
                         Progress& progress) {
    const Image& image = surroundings.remainder;
    if (image.width != width_ || image.height != height_ || image.channels < 3)
        throw InputError("the image is " + std::to_string(image.width) + "x" + std::to_string(image.height) +
                         " but the baker was made for " + std::to_string(width_) + "x" + std::to_string(height_) +
                         ": make a baker for it");
    if (filtered.size() != layout_.size())
        throw InputError("baking: " + std::to_string(filtered.size()) + " places for " +
                         std::to_string(layout_.size()) + " texels");
    Stopwatch watch;
    progress.begin("filtering", 1);
    const Range range = range_of(image);
    report.counts.push_back({"texels", layout_.size()});
    std::vector<ClusterOfLight> lights;
    if (range.least == range.most) {
        std::fill(filtered.begin(), filtered.end(), range.most);
        report.skips.push_back(
            {"harmonics beyond the first band", "the image has one colour",
             std::to_string(plan_.shells().size()) + " shells of up to " + std::to_string(plan_.bands()) + " bands"});
    } else {
        LightSplitting splitting;
        splitting.max_texels = 1 << 20;
        LightSplit split = split_lights(image, splitting);
        std::size_t pixels = 0;
        for (const DistantLight& light : split.lights) {
            lights.push_back(cluster_of(light, least_spread_));
            pixels += light.texels.size();
        }
        report.counts.push_back({"lights split off", split.lights.size()});
        report.counts.push_back({"pixels of lights", pixels});
        report.stages.push_back({"splitting lights off", watch.cpu(), watch.wall()});
        filter_smooth(split.remainder, largest(range_of(split.remainder).most), filtered, report, progress);
        filter_direct(image, filtered, report);
    }
    add_lights(image, lights, surroundings.distant_lights, filtered, report);
    for (glm::vec3& value : filtered)
        value = glm::min(value, glm::vec3(std::numeric_limits<float>::max()));
    progress.advance(1);
}

} // namespace

std::unique_ptr<Baker> spectral_baker(const TexelLayout& layout, int image_width, int image_height,
                                      const SpectralSettings& settings, WorkReport& report, Progress& progress) {
    return std::make_unique<SpectralBaker>(layout, image_width, image_height, settings, report, progress);
}

} // namespace kokage
