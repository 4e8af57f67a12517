#pragma once
// Camera rays become pixels: every ray counts for all pixels within reach of the pixel filter. Private to reflection.
#include "reflection/seen_by_ray.h"

#include <cstdint>
#include <vector>

namespace kokage {

/// A ray's place in its pixel, from the upper left corner, and what it saw.
struct CameraSample {
    glm::vec2 place{0.5f};
    glm::vec3 direction{0.f};
    SeenByRay seen;
};

/// Pixel = sum of f L / N over the rays of its own and its eight neighbours' squares, over the sum of f / N: f is the
/// pixel filter about the pixel's centre (sampling.h), N how many rays the square that a ray starts from has. A ray
/// that serves nine pixels leaves less than half the variance of one that is drawn by the filter for one. Rows come in
/// bands, each of which adds up by itself, so that the result does not depend on threads. Radiance, its parts, albedo
/// and subject are filtered; depth, normal and leaf are of the pixel's own square.
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
    void add(int band, int x, int y, const std::vector<CameraSample>& samples);
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
    glm::vec3 filter_at(float place) const;
    float* sum(Band& band, int x, int row) const;
    void add_to_neighbours(Band& band, int x, int row, const CameraSample& sample, float weight) const;
    void store(Picture& picture, int x, int y) const;

    int width_, height_;
    std::size_t channels_;
    PictureOptions options_;
    CameraFrame frame_;
    std::vector<glm::vec3> filter_; ///< the pixel filter at even steps over a pixel
    std::vector<Band> bands_;
};

} // namespace kokage
