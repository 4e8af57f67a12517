#pragma once
// A set of light-environment maps [F]: where they stand, what they see, and their SH coefficients under a given light
// (eq 1).
#include "common/scene/light_map.h"
#include "foliage/ground_light.h"
#include "foliage/light_map_placement.h"

#include <cstddef>
#include <span>
#include <vector>

namespace kokage {

/// Coefficients of many maps; per map three runs (red, green, blue) of bands^2 floats, index l(l+1)+m.
class MapCoefficients {
  public:
    MapCoefficients() = default;
    MapCoefficients(std::size_t maps, int bands)
        : bands_(bands), maps_(maps), values_(maps * 3 * std::size_t(bands) * std::size_t(bands), 0.f) {}
    std::size_t maps() const { return maps_; }
    int bands() const { return bands_; }
    std::size_t count() const { return std::size_t(bands_) * std::size_t(bands_); }
    float* channel(std::size_t map, int c) { return values_.data() + (3 * map + std::size_t(c)) * count(); }
    const float* channel(std::size_t map, int c) const { return values_.data() + (3 * map + std::size_t(c)) * count(); }
    glm::vec3 at(std::size_t map, std::size_t index) const {
        return {channel(map, 0)[index], channel(map, 1)[index], channel(map, 2)[index]};
    }
    void add(std::size_t map, std::size_t index, const glm::vec3& value) {
        for (int c = 0; c < 3; ++c)
            channel(map, c)[index] += value[std::size_t(c)];
    }
    /// Multiplies every coefficient by the factor of its band.
    void scale_bands(std::span<const double> factors);

  private:
    int bands_ = 0;
    std::size_t maps_ = 0;
    std::vector<float> values_;
};

class CapturedMaps {
  public:
    /// Traces what every place sees in at least `least_directions` directions.
    CapturedMaps(const RayQueries& queries, const GroundCells& ground, std::vector<LightMapPlace> places, int bands,
                 int least_directions, Progress& progress);

    const std::vector<LightMapPlace>& places() const { return places_; }
    const CaptureDirections& directions() const { return directions_; }
    const Capture& seen() const { return capture_; }
    int bands() const { return bands_; }
    std::vector<CapturePoint> points() const;

    /// Adds the sky as seen past the tree. `sky`: mean radiance of every cell of directions().
    void add_sky(std::span<const glm::vec3> sky, MapCoefficients& coefficients) const;
    /// Adds the light that patches and ground cells send.
    void add_surfaces(const SideRadiance& tree, std::span<const glm::vec3> ground, MapCoefficients& coefficients) const;
    /// Adds split-off lights, exactly: irradiance x visible share x the light's own harmonics.
    void add_lights(const Environment& environment, LightVisibility& visibility, float least_m,
                    MapCoefficients& coefficients, Progress& progress) const;

    /// As hosts take them.
    std::vector<LightMap> export_maps(const MapCoefficients& coefficients) const;
    std::size_t bytes() const;

  private:
    std::vector<LightMapPlace> places_;
    int bands_;
    CaptureDirections directions_;
    std::vector<float> weighted_harmonics_; ///< per direction: solid angle x harmonics
    Capture capture_;
};

} // namespace kokage
