#pragma once
// How much light maps are off where the camera looks: rays of bark's lobes, as final gathering traces them, over what
// the maps say there. Private to reflection.
#include "reflection/gathered_sums.h"

namespace kokage {

/// Sums at the corners of smooth surfaces.
class MapCorrections {
  public:
    /// Of so many places of light and looks.
    MapCorrections(std::size_t places, std::size_t looks) : of_places_(places), of_looks_(2 * looks) {}

    /// `look`: GatheredSample::look, whose mean stands in for rays that a corner has too few of.
    void add(const LightPlaces& places, std::uint32_t look, const LobeOfMap& sample);
    /// Scales what the maps give.
    void give(GlossShading& gloss) const;
    /// The most that it takes for so many places, of which samples had so many.
    static double most_bytes(double places, double seen) {
        return ValuesOfSome<Sum<glm::vec3>>::most_bytes(places, seen);
    }

  private:
    template <typename Vector>
    struct Sum {
        Vector ray{0}, map{0};
        typename Vector::value_type weight = 0;
        std::uint32_t look = 0;
        void add(float w, const LobeOfMap& sample, std::uint32_t of_look) {
            ray += Vector(w * sample.ray);
            map += Vector(w * sample.map);
            weight += w;
            look = of_look;
        }
    };
    template <typename Vector>
    static glm::dvec3 ratio(const Sum<Vector>& sum, const glm::dvec3& prior);

    ValuesOfSome<Sum<glm::vec3>> of_places_;
    std::vector<Sum<glm::dvec3>> of_looks_;
};

} // namespace kokage
