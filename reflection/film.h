#pragma once
// Camera rays become pixels: every ray counts for all pixels within reach of the pixel filter. Private to reflection.
#include "reflection/coverage_classes.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace kokage {

/// A ray's place in its pixel, from the upper left corner, and what it saw.
struct CameraSample {
    glm::vec2 place{0.5f};
    glm::vec3 direction{0.f};
    SeenByRay seen;
};

/// All rays of a square. Coverage rays may be none.
struct SquareSamples {
    std::span<const CameraSample> shaded;
    std::span<const CoverageRay> coverage;
    /// One coverage ray of each class (CoverageClasses) that is not among the shaded ones, which was shaded to tell
    /// what its class looks like, and counts for nothing else.
    std::span<const CameraSample> looks;

    /// That the shaded rays met.
    std::vector<std::uint32_t> parts() const;
};

/// Pixel = sum of f L / N over the rays of its own and its eight neighbours' squares, over the sum of f / N: f is the
/// pixel filter about the pixel's centre (sampling.h), N how many rays the square that a ray starts from has. A ray
/// that serves nine pixels leaves less than half the variance of one that is drawn by the filter for one. Where a
/// square has coverage rays as well, all its rays tell how much of it each class of parts takes, and the shaded ones
/// what that looks like: every class's mean radiance is added times what its share by all rays has more than its share
/// by the shaded ones, pixel by pixel (a control variate; shading apart from coverage as in Ragan-Kelley et al.,
/// "Decoupled Sampling for Graphics Pipelines", 2011). Rows come in bands, each of which adds up by itself, so that the
/// result does not depend on threads. Radiance, its parts, albedo and subject are filtered; depth, normal and leaf are
/// of the pixel's own square.
class Film {
  public:
    static constexpr int kBandRows = 16;

    explicit Film(const PictureOptions& options, const CameraFrame& frame);

    /// Squares are those of the picture and one more round it: x in -1 ... width, y in -1 ... height.
    int band_count() const { return int(bands_.size()); }
    int first_row(int band) const { return -1 + band * kBandRows; }
    int end_row(int band) const;
    /// Bytes of a whole one.
    static double bytes(const PictureOptions& options);
    /// All rays of a square of a band. Bands at once, squares of a band one after another in one order.
    void add(int band, int x, int y, const SquareSamples& samples);
    /// When all is added.
    Picture picture() const;

  private:
    struct Nearest {
        float depth = std::numeric_limits<float>::infinity();
        glm::vec3 normal{0.f};
        std::uint32_t leaf = 0;
    };
    /// Rows from one above its first square to one below its last.
    struct Band {
        std::vector<float> sums;
        std::vector<Nearest> nearest; ///< with layers
    };
    static constexpr std::size_t kPlain = 5,
                                 kWithLayers = 17; ///< weight, subject, radiance; direct, indirect, reflection, albedo
    using Values = std::array<float, kWithLayers>;
    /// Of the pixels that a square's rays reach, row by row.
    using Weights = std::array<float, 9>;
    struct Class;

    glm::vec3 filter_at(float place) const;
    Weights weights_at(const glm::vec2& place) const;
    Values values_of(const SeenByRay& seen) const;
    float* sum(Band& band, int x, int row) const;
    void add_to_neighbours(Band& band, int x, int row, const Weights& weights, float scale, const Values& values) const;
    void add_alone(Band& band, int x, int row, std::span<const CameraSample> samples) const;
    void add_covered(Band& band, int x, int row, const SquareSamples& samples) const;
    void store(Picture& picture, int x, int y) const;

    int width_, height_;
    std::size_t channels_;
    PictureOptions options_;
    CameraFrame frame_;
    std::vector<glm::vec3> filter_; ///< the pixel filter at even steps over a pixel
    std::vector<Band> bands_;
};

} // namespace kokage
