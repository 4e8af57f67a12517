#pragma once
// What light transport sees of a tree: triangles grouped into patches, each patch with one reflectance and
// transmittance.
#include "common/scene/alpha_mask.h"
#include "common/types.h"

#include <optional>
#include <vector>

namespace kokage {

/// Two-sided Lambertian scattering, per channel: B+ = (rho E+ + tau E-)/pi, B- = (rho E- + tau E+)/pi. rho + tau <= 1.
struct Optics {
    glm::vec3 reflectance{0.f};
    glm::vec3 transmittance{0.f};
};

enum class PatchKind : std::uint8_t { leaf, bark };

/// A leaf (or a part of one, when leaves are subdivided), or a piece of bark. Bark is closed, so only its front is lit
/// in truth; it is treated like any other two-sided patch with transmittance 0.
struct Patch {
    std::uint32_t first_triangle = 0, triangle_count = 0; ///< a patch's triangles are consecutive
    std::uint32_t optics = 0;                             ///< index in PatchScene::optics
    PatchKind kind = PatchKind::leaf;
    std::uint32_t leaf = 0; ///< kind leaf: index of the leaf in the tree, so that parts average back to their leaf
};

/// An infinite horizontal diffuse plane, lit from above.
struct Ground {
    float height_m = 0;
    glm::vec3 albedo{0.2f};
};

/// No triangle index may be out of range, positions are finite; areas may be zero. Check with validate().
struct PatchScene {
    std::vector<glm::vec3> positions;
    std::vector<glm::vec2> uvs; ///< as long as positions, or empty when no mask is used
    std::vector<glm::uvec3> triangles;
    std::vector<std::uint32_t> triangle_patch; ///< as long as triangles
    std::vector<std::int16_t>
        triangle_mask; ///< index in masks, -1 = solid; as long as triangles, or empty when no mask is used
    std::vector<AlphaMask> masks;
    std::vector<Patch> patches;
    std::vector<Optics> optics;
    std::uint32_t leaf_count = 0;
    std::optional<Ground> ground;

    bool masked(std::size_t triangle) const { return !triangle_mask.empty() && triangle_mask[triangle] >= 0; }
};

struct Bounds {
    glm::vec3 low{0.f}, high{0.f};
    glm::vec3 centre() const { return low + 0.5f * (high - low); }
    float diagonal() const { return glm::length(high - low); }
};

/// Box of all triangles' corners; a zero box at the origin if there are none.
Bounds bounds_of(const PatchScene& scene);

/// Solid share of every triangle's area (alpha holes taken out, by counting mask texel centres or fixed sample points);
/// empty if no mask is used.
std::vector<float> solid_shares(const PatchScene& scene);

/// Solid area of every patch in m^2, by solid_shares().
std::vector<double> solid_areas(const PatchScene& scene);

/// Throws InputError naming the first inconsistent index or non-finite number.
void validate(const PatchScene& scene);

} // namespace kokage
