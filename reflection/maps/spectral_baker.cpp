#include "reflection/maps/spectral_baker.h"
#include "common/environment/split_lights.h"
#include "common/services/checked_file.h"
#include "common/services/error.h"
#include "common/services/large_vector.h"
#include "common/services/parallel.h"
#include "common/services/stopwatch.h"
#include "reflection/maps/lobe_lights.h"
#include "reflection/maps/near_sums.h"
#include "reflection/maps/shell_map.h"
#include "reflection/maps/spectral_plan.h"
#include "reflection/maps/spectral_read.h"
#include "reflection/maps/split_surroundings.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>

namespace kokage {
namespace {

constexpr std::size_t kReadBlock = 4096;
constexpr std::size_t kNearBlock = 64;
constexpr double kEvenContrast = 4; ///< brightest pixel over mean, up to which an image has no bright parts

std::string text(const char* format, double value) {
    char buffer[64];
    std::snprintf(buffer, sizeof buffer, format, value);
    return buffer;
}

struct Range {
    glm::vec3 least, most;
    double mean; ///< of all channels over the sphere
};

/// Per channel; throws if a pixel is negative or no number.
Range range_of(const Image& image) {
    Range range{glm::vec3(std::numeric_limits<float>::max()), glm::vec3(0), 0};
    for (int y = 0; y < image.height; ++y) {
        double sum = 0;
        for (int x = 0; x < image.width; ++x) {
            const float* p = image.at(x, y);
            const glm::vec3 pixel(p[0], p[1], p[2]);
            if (!(pixel.r >= 0 && pixel.g >= 0 && pixel.b >= 0 && std::isfinite(std::max({p[0], p[1], p[2]}))))
                throw InputError("baking: the pixel at " + std::to_string(x) + ", " + std::to_string(y) +
                                 " is negative or not a finite number: repair the image first");
            range.least = glm::min(range.least, pixel);
            range.most = glm::max(range.most, pixel);
            sum += double(p[0]) + double(p[1]) + double(p[2]);
        }
        range.mean += sum / 3 * pixel_solid_angle(y, image.width, image.height) / (4 * kPiDouble);
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

constexpr CheckedFileKind kStoredSetup{{'K', 'o', 'k', 'a', 'g', 'e', 'S', 'H'},
                                       3,
                                       "stored set-up of the spectral baker",
                                       "a map or images of another size, lobe, range or tolerance"};

/// A stored set-up's arrays in the order in which they were written; empty ones where nothing is stored.
class StoredArrays {
  public:
    StoredArrays() = default;
    StoredArrays(const std::filesystem::path& path, std::uint64_t identity) : file_({path, kStoredSetup, identity}) {}
    explicit operator bool() const { return file_.has_value(); }
    std::span<const float> next() { return file_ ? file_->array<float>(next_++) : std::span<const float>(); }
    const CheckedFile& file() const { return *file_; }

  private:
    std::optional<CheckedFile> file_;
    std::size_t next_ = 0;
};

class SpectralBaker final : public Baker {
  public:
    SpectralBaker(const TexelLayout& layout, int width, int height, const SpectralSettings& settings,
                  WorkReport& report, Progress& progress);
    void bake(const Environment& surroundings, std::span<glm::vec3> filtered, WorkReport& report,
              Progress& progress) override;

  private:
    void place_texels();
    void normalize(StoredArrays& stored);
    void make_tables(StoredArrays& stored, Progress& progress);
    std::vector<std::span<const float>> tables() const;
    std::uint64_t identity() const;
    void store(const std::filesystem::path& path, WorkReport& report) const;
    void filter_smooth(const Image& image, const Range& range, std::span<glm::vec3> filtered, WorkReport& report,
                       Progress& progress);
    void skip_bands(WorkReport& report) const;
    void filter_near(const Image& image, const Image& remainder, std::span<glm::vec3> filtered, WorkReport& report,
                     Progress& progress);

    Stopwatch watch_; ///< runs from the beginning of the set-up
    TexelLayout layout_;
    int width_, height_;
    SpectralSettings settings_;
    SpectralPlan plan_;
    LargeVector<TexelPlace> places_;
    std::vector<std::uint32_t> near_; ///< texels of which some or all is summed pixel by pixel
    std::optional<RingAnalysis> analysis_;
    /// Neighbouring shells with grids of one size: they share a table.
    struct ShellGroup {
        std::size_t first, count;
        RingSynthesis synthesis;
    };
    std::vector<ShellGroup> groups_;
    std::vector<std::vector<double>> zonals_, even_zonals_; ///< of each shell; those of images without bright parts
    std::vector<RingGrid> grids_;                           ///< of each shell
    LobeLights lights_;
    std::vector<float> smooth_sums_; ///< of each texel's weights in harmonics, of which each lobe has mass 1
    std::vector<float> factors_;     ///< of each texel: 1 over the sum of its weights, with near parts once they were
                                     ///< summed; 0 where all is near
    double least_spread_;
};

SpectralBaker::SpectralBaker(const TexelLayout& layout, int width, int height, const SpectralSettings& settings,
                             WorkReport& report, Progress& progress)
    : layout_(layout), width_(width), height_(height), settings_(settings),
      plan_(layout, width, height, settings.tolerance), lights_(layout_), least_spread_(least_spread(layout_)) {
    progress.begin("preparing harmonics", plan_.shells().size() + 1);
    const std::filesystem::path& path = settings.stored_setup;
    std::error_code ignored;
    const bool is_stored = !path.empty() && std::filesystem::exists(path, ignored);
    StoredArrays stored = is_stored ? StoredArrays(path, identity()) : StoredArrays();
    make_tables(stored, progress);
    place_texels();
    normalize(stored);
    report.stages.push_back({is_stored ? "reading the set-up" : "preparing harmonics", watch_.cpu(), watch_.wall()});
    if (!path.empty() && !is_stored)
        store(path, report);
    std::size_t bytes = lights_.bytes() + places_.size() * sizeof(TexelPlace) + factors_.size() * sizeof(float);
    for (const RingGrid& grid : grids_)
        bytes += grid.cells.size() * sizeof(glm::vec4);
    for (const std::span<const float> array : tables())
        bytes += array.size_bytes();
    report.counts.push_back({"bands", std::uint64_t(plan_.shells().empty() ? 0 : plan_.bands())});
    report.counts.push_back({"spectral shells", plan_.shells().size()});
    report.counts.push_back({"texels with pixels nearby summed", near_.size()});
    report.counts.push_back({"prepared bytes", bytes});
}

/// Whatever the tables and factors depend on.
std::uint64_t SpectralBaker::identity() const {
    FileIdentity identity;
    identity.add_value(int(layout_.kind));
    identity.add(std::as_bytes(std::span(layout_.directions)));
    identity.add(std::as_bytes(std::span(layout_.parameters)));
    identity.add_value(width_);
    identity.add_value(height_);
    identity.add_value(settings_.tolerance);
    for (const SpectralShell& shell : plan_.shells()) {
        identity.add_value(shell.zonal.size());
        identity.add_value(shell.rings);
    }
    return identity.value();
}

void SpectralBaker::make_tables(StoredArrays& stored, Progress& progress) {
    const std::vector<SpectralShell>& shells = plan_.shells();
    if (shells.empty())
        return;
    analysis_.emplace(width_, height_, plan_.bands(), stored.next());
    progress.advance(1);
    for (std::size_t begin = 0, end = 0; begin < shells.size(); begin = end) {
        progress.throw_if_stopped();
        const int rings = shells[begin].rings;
        std::size_t bands = 0;
        for (; end < shells.size() && shells[end].rings == rings; ++end) {
            bands = std::max(bands, shells[end].zonal.size());
            zonals_.push_back(shells[end].zonal);
            even_zonals_.emplace_back(shells[end].zonal.begin(), shells[end].zonal.begin() + shells[end].even_bands);
            grids_.emplace_back(rings, 2 * rings);
        }
        groups_.push_back({begin, end - begin, RingSynthesis(int(bands), rings, 2 * rings, stored.next())});
        progress.advance(end - begin);
    }
}

std::vector<std::span<const float>> SpectralBaker::tables() const {
    std::vector<std::span<const float>> arrays;
    if (analysis_)
        arrays.push_back(analysis_->tables());
    for (const ShellGroup& group : groups_)
        arrays.push_back(group.synthesis.tables());
    return arrays;
}

void SpectralBaker::store(const std::filesystem::path& path, WorkReport& report) const {
    const Stopwatch watch;
    std::vector<std::span<const std::byte>> arrays;
    for (const std::span<const float> array : tables())
        arrays.push_back(std::as_bytes(array));
    arrays.push_back(std::as_bytes(std::span(smooth_sums_)));
    write_checked_file(path, kStoredSetup, identity(), arrays);
    report.stages.push_back({"writing the set-up", watch.cpu(), watch.wall()});
}

void SpectralBaker::place_texels() {
    std::vector<std::uint32_t> spectral;
    for (std::size_t i = 0; i < layout_.size(); ++i) {
        const float parameter = layout_.parameters[i];
        if (!plan_.is_near_only(parameter))
            spectral.push_back(std::uint32_t(i));
        if (plan_.near_part(parameter).reach > 0)
            near_.push_back(std::uint32_t(i));
    }
    places_.resize(spectral.size());
    parallel_blocks(spectral.size(), kReadBlock, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            places_[i] =
                texel_place(layout_.directions[spectral[i]], plan_.mix(layout_.parameters[spectral[i]]), spectral[i]);
    });
}

/// The sum over pixels is divided by the sum of their weights ([R] eq 9), which is 1 but near the poles, where a row of
/// pixels stands for a whole cap, and where pixels are coarse: the same bake of a white image. Near parts are added to
/// both when they are summed.
void SpectralBaker::normalize(StoredArrays& stored) {
    if (places_.empty())
        return;
    const std::span<const float> known = stored.next();
    smooth_sums_.assign(known.begin(), known.end());
    if (stored && smooth_sums_.size() != layout_.size())
        stored.file().refuse_altered("its texels are not as many as the map's");
    if (!stored) {
        Image white(width_, height_, 3);
        std::fill(white.pixels.begin(), white.pixels.end(), 1.f);
        std::vector<glm::vec3> sums(layout_.size());
        WorkReport unused;
        filter_smooth(white, {glm::vec3(1), glm::vec3(1), 0}, sums, unused, silent_progress());
        for (const glm::vec3& sum : sums)
            smooth_sums_.push_back(sum.g);
    }
    factors_.assign(layout_.size(), 0.f);
    for (TexelPlace& place : places_)
        if (!(plan_.near_part(layout_.parameters[place.texel]).reach > 0)) {
            factors_[place.texel] = 1 / smooth_sums_[place.texel];
            for (float& weight : place.weights)
                weight *= factors_[place.texel];
        }
}

void SpectralBaker::filter_smooth(const Image& image, const Range& range, std::span<glm::vec3> filtered,
                                  WorkReport& report, Progress& progress) {
    if (places_.empty())
        return;
    Stopwatch watch;
    const float most = largest(range.most), scale = scale_to_one(most);
    const bool even = double(most) <= kEvenContrast * range.mean;
    RingCoefficients coefficients(plan_.bands());
    analysis_->transform(image, scale, coefficients);
    report.stages.push_back({"harmonics of the image", watch.cpu(), watch.wall()});
    watch.restart();
    const std::span<const std::vector<double>> zonals(even ? even_zonals_ : zonals_);
    for (const ShellGroup& group : groups_)
        for (std::size_t done = 0; done < group.count; done += RingSynthesis::kMostGrids) {
            progress.throw_if_stopped();
            const std::size_t first = group.first + done,
                              count = std::min(group.count - done, RingSynthesis::kMostGrids);
            group.synthesis.transform(coefficients, zonals.subspan(first, count), 1,
                                      std::span(grids_).subspan(first, count));
        }
    report.stages.push_back({"filtering on rings", watch.cpu(), watch.wall()});
    if (even)
        skip_bands(report);
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

void SpectralBaker::skip_bands(WorkReport& report) const {
    std::size_t all = 0, used = 0;
    for (std::size_t i = 0; i < zonals_.size(); ++i) {
        all += zonals_[i].size() * zonals_[i].size();
        used += even_zonals_[i].size() * even_zonals_[i].size();
    }
    if (used < all)
        report.skips.push_back({"highest bands of each lobe", "no part of the image is many times its mean",
                                std::to_string(all - used) + " of " + std::to_string(all) + " coefficients filtered"});
}

/// Lobes that are near only see the whole image; near parts the remainder, because lights are added as whole lobes.
void SpectralBaker::filter_near(const Image& image, const Image& remainder, std::span<glm::vec3> filtered,
                                WorkReport& report, Progress& progress) {
    if (near_.empty())
        return;
    const Stopwatch watch;
    const bool whole = plan_.is_near_only(layout_.parameters[near_.front()]); // then all of them are
    const Image& seen = whole ? image : remainder;
    const float scale = scale_to_one(largest(range_of(seen).most));
    NearSums pixels(width_, height_);
    pixels.set_pixels(seen, scale);
    parallel_blocks(near_.size(), kNearBlock, [&](std::size_t begin, std::size_t end) {
        progress.throw_if_stopped();
        NearSums::Scratch scratch;
        for (std::size_t i = begin; i < end; ++i) {
            const std::uint32_t texel = near_[i];
            const float parameter = layout_.parameters[texel];
            const NearLobe near = plan_.near_part(parameter);
            const glm::dvec3 direction = glm::normalize(glm::dvec3(layout_.directions[texel]));
            if (whole) {
                filtered[texel] = pixels.whole(near, direction, scratch) / scale;
                continue;
            }
            const glm::dvec4 part = lobe_value(near.lobe, 0) * pixels.part(near, direction, scratch);
            const double share = plan_.smooth_share(parameter),
                         factor = 1 / (share * double(smooth_sums_[texel]) + part.w);
            factors_[texel] = float(factor);
            filtered[texel] =
                glm::vec3(factor * (share * glm::dvec3(filtered[texel]) + glm::dvec3(part) / double(scale)));
        }
        progress.advance(end - begin);
    });
    report.stages.push_back({"summing pixels nearby", watch.cpu(), watch.wall()});
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
    progress.begin("filtering", near_.size() + 1);
    const Range range = range_of(image);
    report.counts.push_back({"texels", layout_.size()});
    SplitSurroundings split = split_surroundings(surroundings, least_spread_, report);
    if (range.least == range.most) {
        std::fill(filtered.begin(), filtered.end(), range.most);
        report.skips.push_back(
            {"harmonics beyond the first band", "the image has one colour",
             std::to_string(plan_.shells().size()) + " shells of up to " + std::to_string(plan_.bands()) + " bands"});
    } else {
        filter_smooth(split.remainder, range_of(split.remainder), filtered, report, progress);
        filter_near(image, split.remainder, filtered, report, progress);
    }
    if (places_.empty())
        split.of_image.clear(); // they are in what was summed pixel by pixel
    const double mean = luminance_integral(image) / (4 * kPiDouble);
    add_lights(split, lights_, factors_, float(std::min(1e-6, 1e-2 * settings_.tolerance) * mean), filtered, report);
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
