#pragma once
// Draws directions towards the bright parts of an environment's remainder.
#include "common/environment/environment.h"

#include <vector>

namespace kokage {

/// Density in proportion to luminance over cells of at most 512 x 256 (pixels, where the image is smaller).
/// Thread-safe.
class RemainderSampler {
  public:
    /// `remainder` (lat-long RGB) must outlive the sampler. Throws InputError if it has no pixel or less than 3
    /// channels.
    explicit RemainderSampler(const Image& remainder);

    /// What sample() drew.
    struct Sample {
        glm::vec3 direction;
        float density; ///< per sr
    };
    /// `numbers` and `choice` are uniform in [0, 1).
    Sample sample(glm::vec2 numbers, float choice) const;
    /// Density per sr with which sample() draws a direction.
    float density(const glm::vec3& direction) const;
    glm::vec3 radiance(const glm::vec3& direction) const;
    /// Mean over the sphere of luminance^2 over the mean's square: 1 for a constant environment, large for a few bright
    /// spots.
    double contrast() const { return contrast_; }

  private:
    struct Cell {
        float keep; ///< alias method: below, this cell, else `other`
        std::uint32_t other;
    };
    void fill_cells();
    void build_alias_table(const std::vector<double>& weights);

    const Image& remainder_;
    bool constant_ = false;
    int width_ = 0, height_ = 0;
    double contrast_ = 1;
    std::vector<float> row_top_cosine_; ///< height + 1 cosines of the polar angle between rows
    std::vector<float> density_;
    std::vector<Cell> cells_;
};

} // namespace kokage
