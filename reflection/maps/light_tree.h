#pragma once
// Points of light, gathered into a tree: from afar, or through a wide lobe, a few of them do for many.
#include "reflection/maps/lobe_lights.h"

#include <vector>

namespace kokage {

/// Bounds of a lobe's value and of its first and second derivative by distance, at a distance and all larger ones.
/// Distances are those between unit directions (chords).
struct LobeBounds {
    LobeKind kind;
    float peak;             ///< largest value of any of the lobes that are meant
    float widest, steepest; ///< LobeArrays::shape (Phong's Λ, GGX's falloff) of the widest and the narrowest of them
    struct Change {
        float value, slope, curvature;
    };
    Change from(float distance) const;
};

/// Over one cluster's points; made for a bake.
class LightTree {
  public:
    explicit LightTree(const ClusterOfLight& cluster);

    /// Appends points that stand for those within `reach` of `axis`, such that for any texel within `chord` of the
    /// axis, and lobes of these bounds, no point that stands for others is off by more than `error` in what it adds.
    void gather(const glm::vec3& axis, float chord, float reach, const LobeBounds& lobes, float error,
                std::vector<PointOfLight>& points) const;

  private:
    struct Node {
        PointOfLight middle; ///< all of its points, at their centre of irradiance
        float radius = 0;    ///< largest distance of a point from there
        float first = 0,
              second = 0; ///< |sum of irradiance x offset|, sum of irradiance x offset²; the largest channel's
        std::uint32_t begin = 0, end = 0; ///< of points_
        std::uint32_t other = 0;          ///< second child; the first one follows its parent; 0: a leaf
    };
    std::uint32_t add_node(std::uint32_t begin, std::uint32_t end);

    std::vector<PointOfLight> points_;
    std::vector<Node> nodes_;
};

} // namespace kokage
