#pragma once
// What lies within a narrow cap around a direction, pixel by pixel, by vectors: the part of a lobe that harmonics of
// few bands can't hold. Every pixel is a point of light at its centre, as in brute_force_baker.h.
#include "reflection/maps/lat_long_sums.h"

namespace kokage {

/// A lobe's near part: ggx_smooth_part's complement (common/directions/lobes.h); or the whole lobe.
struct NearLobe {
    Lobe lobe;
    double sharpest = 0; ///< GGX: above it the mixture's lobes are near; 0: all of them
    double reach = 1;    ///< w = 1 - cos of the cap, at most 1, where lobes end; a few pixels beyond it count too
};

class NearSums {
  public:
    NearSums(int image_width, int image_height);
    /// Values are multiplied by `scale` first. Not called yet: all pixels are 0.
    void set_pixels(const Image& image, float scale = 1) { planes_.set_pixels(image, scale); }

    /// Kept from texel to texel by each thread.
    struct Scratch {
        struct Row {
            int row;
            int first, count;    ///< columns, counted from the one before the direction's
            float height, slope; ///< w = height + slope x (1 - cos of the turn)
        };
        std::vector<Row> rows;
        std::vector<float> turns;
    };
    /// Sums over pixels of solid angle x (near part of the lobe over the whole lobe's peak) x pixel, and (fourth)
    /// without the pixel. Direction: unit.
    glm::dvec4 part(const NearLobe& near, const glm::dvec3& direction, Scratch& scratch) const;
    /// The whole lobe's sum over pixels within reach, divided by that of the weights (sharpest = 0). Where a Phong lobe
    /// has no pixel in its peak, weights and reach are relative to the nearest pixel's; where all pixels are beyond the
    /// lobe's right angle, it is the nearest pixel.
    glm::vec3 whole(const NearLobe& near, const glm::dvec3& direction, Scratch& scratch) const;

  private:
    struct Place {
        double sine, cosine; ///< of the angle from +Y
        int column;          ///< the last pixel centre before the direction, may be -1
        double fraction;     ///< how far behind it, in columns
    };
    Place place_of(const glm::dvec3& direction) const;
    double along_meridian(const Place& place, int row) const;
    struct Nearest {
        double w = 5; ///< 1 - cos
        int x = 0, y = 0;
    };
    Nearest nearest(const Place& place) const;
    glm::dvec4 sums(const NearLobe& near, const Place& place, double nearest, Scratch& scratch) const;
    void find_rows(const Place& place, double reach, double nearest, Scratch& scratch) const;

    LatLongPlanes planes_;
    int before_;                                 ///< columns of the half circle before a direction, its own among them
    std::vector<float> half_sine_, half_cosine_; ///< of turns by -before_ ... width_ - before_ columns
};

} // namespace kokage
