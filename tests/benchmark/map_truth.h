#pragma once
// What a map's texels should hold, at a sample of them.
#include "common/environment/environment.h"
#include "reflection/maps/texel_layout.h"
#include "tests/benchmark/reflection_record.h"

#include <cstddef>
#include <span>
#include <vector>

namespace kokage {

/// A sample of a layout's texels that depends on the layout alone.
struct TexelSample {
    std::vector<std::size_t> texels; ///< ascending
    TexelLayout layout;              ///< of those texels alone
};

/// Every texel with the same chance: what a mean over texels is taken of. All of them if there are no more than
/// `count`.
TexelSample even_sample(const TexelLayout& layout, std::size_t count);

/// As many texels of every width of lobe (in equal steps of the logarithm of the parameter), so that rough shells,
/// which are few texels, are judged as hard as smooth ones: what a maximum is taken of.
TexelSample sample_of_all_shells(const TexelLayout& layout, std::size_t count);

/// By brute force (reflection/maps/brute_force_baker.h).
std::vector<glm::vec3> true_texels(const TexelSample& sample, const Environment& surroundings);

/// The paper's truth: the lobe summed over the 51842 vertices of the finest dome, each counting the same, the image
/// taken bilinearly ([R] eqs 8, 9).
std::vector<glm::vec3> true_texels_by_dome(const TexelSample& sample, const Image& image);

/// Errors over texels and channels, into the record's error fields. Sizes must agree.
void judge(std::span<const glm::vec3> values, std::span<const glm::vec3> truth, ReflectionRecord& record);
/// The sample's texels of all that were filtered.
std::vector<glm::vec3> values_at(const TexelSample& sample, std::span<const glm::vec3> filtered);

} // namespace kokage
