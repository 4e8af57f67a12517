#pragma once
// The gloss of a surface: what it mirrors beside its diffuse light, one model for the renderer and for its truth.
//
//     L(v) = (1 - k) diffuse(v) + K(n·v) ∫ lobe(r·l) L(l) dl over l above the horizon,    r = 2 (n·v) n - v
//
// The lobe is GGX as glTF's roughness means it, seen along the normal (maps/lobe.h), of mass 1 over the sphere; where
// the horizon clips it, the rest is lost ([R] eqs 1 and 2 with PAPERS' normalisation). K is Schlick's Fresnel term,
// which rough surfaces reach less of; k its mean over the hemisphere, so that nothing is given twice.
#include "common/scene/image.h"
#include "common/types.h"

#include <memory>
#include <optional>

namespace kokage {

/// Roughness that changes linearly between two heights (+Y, metres), and stays beyond them.
struct RoughnessGradient {
    float foot_height = 0, top_height = 1;
    float foot = 1, top = 1;
    float at(float height) const;
};

struct Gloss {
    /// Reflectance at normal incidence; 0.04 for what is not a metal, a metal's colour. 0: matt.
    glm::vec3 normal_reflectance{0.f};
    float roughness = 1; ///< glTF's, 0 … 1; smoother than kLeastRoughness counts as that
    /// 1 channel, times `roughness`; read as the base colour's texture is. Null: the same all over.
    std::shared_ptr<const Image> roughness_texture;
    /// Times the texture, in place of `roughness`.
    std::optional<RoughnessGradient> roughness_gradient;
    /// The part of normal_reflectance that the base colour's texture colours: a metal's.
    glm::vec3 tinted_reflectance{0.f};

    bool is_matt() const { return !(normal_reflectance.r > 0 || normal_reflectance.g > 0 || normal_reflectance.b > 0); }
};

/// The least and the most roughness of a gloss, and its mean, before kLeastRoughness.
struct RoughnessBounds {
    float least = 1, most = 0, mean = 1;
};
RoughnessBounds roughness_bounds(const Gloss& gloss);

/// A mirror has no lobe.
inline constexpr float kLeastRoughness = 0.02f;

/// K at a cosine of view direction and normal (Schlick 1994; the limit at grazing angles falls with roughness, Lagarde
/// 2011).
glm::vec3 gloss_reflectance(const glm::vec3& normal_reflectance, float roughness, float cosine);
/// k: its mean over the hemisphere, weighted by the cosine.
glm::vec3 mean_gloss_reflectance(const glm::vec3& normal_reflectance, float roughness);

/// A direction drawn from about the lobe, from two uniform numbers.
struct LobeSample {
    glm::vec3 direction;
    float weight;  ///< lobe / density: at most 2, mean 1; 0 where the lobe is 0
    float density; ///< per sr
};
LobeSample sample_gloss(const glm::vec3& mirrored, float roughness, glm::vec2 numbers);
/// With which sample_gloss draws a direction.
float gloss_density(const glm::vec3& mirrored, float roughness, const glm::vec3& direction);

} // namespace kokage
