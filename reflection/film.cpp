#include "reflection/film.h"
#include "reflection/sampling.h"

#include <algorithm>
#include <array>

namespace kokage {
namespace {

constexpr int kFilterSteps = 512;

/// The pixel filter at places from 0 to 1: of the pixel before, its own and the pixel behind.
std::vector<glm::vec3> filter_table() {
    std::vector<glm::vec3> table;
    for (int k = 0; k <= kFilterSteps; ++k) {
        const float place = float(k) / kFilterSteps;
        table.push_back({pixel_filter(place + 0.5f), pixel_filter(place - 0.5f), pixel_filter(place - 1.5f)});
    }
    return table;
}

/// The most frequent; of equals the smallest.
std::uint32_t most_frequent_leaf(std::span<const CameraSample> samples) {
    std::vector<std::uint32_t> leaves;
    for (const CameraSample& sample : samples)
        leaves.push_back(sample.seen.leaf);
    return most_frequent(leaves);
}

} // namespace

std::vector<std::uint32_t> SquareSamples::parts() const {
    std::vector<std::uint32_t> met;
    for (const CameraSample& sample : shaded)
        met.push_back(sample.seen.part);
    return met;
}

Film::Film(const PictureOptions& options, const CameraFrame& frame)
    : width_(options.width), height_(options.height), channels_(options.layers ? kWithLayers : kPlain),
      options_(options), frame_(frame), filter_(filter_table()) {
    bands_.resize(std::size_t((height_ + 2 + kBandRows - 1) / kBandRows));
}

double Film::bytes(const PictureOptions& options) {
    const double sums = double(sizeof(float) * (options.layers ? kWithLayers : kPlain)) * (kBandRows + 2) / kBandRows;
    return double(options.width) * double(options.height) * (sums + (options.layers ? double(sizeof(Nearest)) : 0));
}

int Film::end_row(int band) const {
    return std::min(first_row(band) + kBandRows, height_ + 1);
}

glm::vec3 Film::filter_at(float place) const {
    const float step = std::clamp(place, 0.f, 1.f) * kFilterSteps;
    const int before = std::min(int(step), kFilterSteps - 1);
    return glm::mix(filter_[std::size_t(before)], filter_[std::size_t(before) + 1], step - float(before));
}

/// `row` from 0: the row above the band's first.
float* Film::sum(Band& band, int x, int row) const {
    return band.sums.data() + (std::size_t(row) * std::size_t(width_) + std::size_t(x)) * channels_;
}

Film::Weights Film::weights_at(const glm::vec2& place) const {
    const glm::vec3 across = filter_at(place.x), down = filter_at(place.y);
    Weights weights;
    for (std::size_t j = 0; j < 3; ++j)
        for (std::size_t i = 0; i < 3; ++i)
            weights[3 * j + i] = across[i] * down[j];
    return weights;
}

Film::Values Film::values_of(const SeenByRay& seen) const {
    Values values;
    values[0] = 1;
    values[1] = seen.surface ? 1.f : 0.f;
    const auto put = [&](std::size_t at, const glm::vec3& rgb) {
        const glm::dvec3 finite = displayable(rgb);
        for (std::size_t c = 0; c < 3; ++c)
            values[at + c] = float(finite[c]);
    };
    put(2, seen.radiance);
    if (channels_ == kWithLayers) {
        put(5, seen.direct);
        put(8, seen.indirect);
        put(11, seen.reflection);
        put(14, seen.albedo);
    }
    return values;
}

void Film::add_to_neighbours(Band& band, int x, int row, const Weights& weights, float scale,
                             const Values& values) const {
    for (int j = 0; j < 3; ++j)
        for (int i = std::max(0, 1 - x); i < 3 && x + i - 1 < width_; ++i) {
            const float share = scale * weights[std::size_t(3 * j + i)];
            float* to = sum(band, x + i - 1, row + j);
            for (std::size_t k = 0; k < channels_; ++k)
                to[k] += share * values[k];
        }
}

/// Rays of a square that look alike.
struct Film::Class {
    std::uint32_t number;
    float shaded = 0;  ///< rays
    Values values{};   ///< their sum
    Weights weights{}; ///< by all rays less by the shaded ones

    void add(const Weights& more, float scale) {
        for (std::size_t k = 0; k < more.size(); ++k)
            weights[k] += scale * more[k];
    }
    void add_shaded(const Values& more, float rays, std::size_t channels) {
        shaded += rays;
        for (std::size_t k = 0; k < channels; ++k)
            values[k] += more[k];
    }
    Values mean(std::size_t channels) const {
        Values result{};
        for (std::size_t k = 0; k < channels; ++k)
            result[k] = values[k] / shaded;
        return result;
    }
};

void Film::add_alone(Band& band, int x, int row, std::span<const CameraSample> samples) const {
    for (const CameraSample& sample : samples)
        add_to_neighbours(band, x, row, weights_at(sample.place), 1 / float(samples.size()), values_of(sample.seen));
}

void Film::add_covered(Band& band, int x, int row, const SquareSamples& samples) const {
    const auto shaded = float(samples.shaded.size()), all = shaded + float(samples.coverage.size());
    const CoverageClasses numbers(samples.coverage, samples.parts());
    std::vector<Class> classes;
    const auto class_of = [&](std::uint32_t part) -> Class& {
        const std::uint32_t number = numbers.of(part);
        for (Class& known : classes)
            if (known.number == number)
                return known;
        return classes.emplace_back(Class{.number = number});
    };
    for (const CameraSample& sample : samples.shaded) {
        const Weights weights = weights_at(sample.place);
        const Values values = values_of(sample.seen);
        add_to_neighbours(band, x, row, weights, 1 / shaded, values);
        Class& of = class_of(sample.seen.part);
        of.add(weights, 1 / all - 1 / shaded);
        of.add_shaded(values, 1, channels_);
    }
    for (const CameraSample& look : samples.looks)
        class_of(look.seen.part).add_shaded(values_of(look.seen), 1, channels_);
    for (const CoverageRay& ray : samples.coverage)
        class_of(ray.part).add(weights_at(ray.place), 1 / all);
    Class any{.number = 0};
    for (const Class& of : classes)
        any.add_shaded(of.values, of.shaded, channels_);
    // At edges a ray that was traced again among others may meet the neighbour: then its class has no look.
    for (const Class& of : classes)
        add_to_neighbours(band, x, row, of.weights, 1, (of.shaded > 0 ? of : any).mean(channels_));
}

void Film::add(int band, int x, int y, const SquareSamples& samples) {
    Band& sums = bands_[std::size_t(band)];
    const int rows = end_row(band) - first_row(band);
    if (sums.sums.empty())
        sums.sums.assign(std::size_t(rows + 2) * std::size_t(width_) * channels_, 0.f);
    if (samples.coverage.empty())
        add_alone(sums, x, y - first_row(band), samples.shaded);
    else
        add_covered(sums, x, y - first_row(band), samples);
    if (channels_ != kWithLayers || x < 0 || x >= width_)
        return;
    if (sums.nearest.empty())
        sums.nearest.resize(std::size_t(rows) * std::size_t(width_));
    Nearest& nearest = sums.nearest[std::size_t(y - first_row(band)) * std::size_t(width_) + std::size_t(x)];
    for (const CameraSample& sample : samples.shaded)
        if (const float depth = sample.seen.distance * glm::dot(sample.direction, frame_.forward);
            depth < nearest.depth) {
            nearest.depth = depth;
            nearest.normal = sample.seen.normal;
        }
    nearest.leaf = most_frequent_leaf(samples.shaded);
}

void Film::store(Picture& picture, int x, int y) const {
    std::array<double, kWithLayers> total{};
    const int own = (y + 1) / kBandRows;
    for (int band = std::max(0, own - 1); band <= own + 1 && band < band_count(); ++band) {
        const int row = y - first_row(band) + 1; // of its sums
        if (row < 0 || row >= end_row(band) - first_row(band) + 2)
            continue;
        const float* from = bands_[std::size_t(band)].sums.data() +
                            (std::size_t(row) * std::size_t(width_) + std::size_t(x)) * channels_;
        for (std::size_t k = 0; k < channels_; ++k)
            total[k] += double(from[k]);
    }
    // Corrections by coverage may take more than a pixel has. (Reflection may be negative by its own estimate.)
    const auto mean = [&](Image& image, std::size_t at, bool positive = false) {
        for (std::size_t c = 0; c < std::size_t(image.channels); ++c) {
            const double value = total[at + c] / total[0];
            image.at(x, y)[c] = float(positive ? std::max(0., value) : value);
        }
    };
    mean(picture.radiance, 2, true);
    mean(picture.subject, 1, true);
    if (!picture.layers)
        return;
    PictureLayers& layers = *picture.layers;
    mean(layers.direct, 5, true);
    mean(layers.indirect, 8, true);
    mean(layers.reflection, 11);
    mean(layers.albedo, 14, true);
    const Nearest& nearest =
        bands_[std::size_t(own)].nearest[std::size_t(y - first_row(own)) * std::size_t(width_) + std::size_t(x)];
    layers.depth.at(x, y)[0] = nearest.depth;
    layers.leaf.at(x, y)[0] = float(nearest.leaf);
    for (std::size_t c = 0; c < 3; ++c)
        layers.normal.at(x, y)[c] = nearest.normal[c];
}

Picture Film::picture() const {
    Picture picture = empty_picture(options_);
    for (int y = 0; y < height_; ++y)
        for (int x = 0; x < width_; ++x)
            store(picture, x, y);
    return picture;
}

} // namespace kokage
