#include "common/scene/patch_scene.h"
#include "common/services/error.h"
#include "common/services/random.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <string>
#include <unordered_map>

namespace kokage {
namespace {

[[noreturn]] void refuse(const std::string& what) {
    throw InputError("scene: " + what);
}

bool finite(const glm::vec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

void validate_optics(const std::vector<Optics>& optics) {
    for (std::size_t i = 0; i < optics.size(); ++i)
        for (std::size_t c = 0; c < 3; ++c) {
            const float reflectance = optics[i].reflectance[c], transmittance = optics[i].transmittance[c];
            // Written so that NaN fails too. The slack lets colours through that were scaled to a sum of 1 in float.
            if (!(reflectance >= 0 && transmittance >= 0 && reflectance + transmittance <= 1.00001f))
                refuse("optics " + std::to_string(i) + " has reflectance " + std::to_string(reflectance) +
                       " and transmittance " + std::to_string(transmittance) + " in channel " + std::to_string(c) +
                       "; both must be at least 0 and their sum at most 1");
        }
}

void validate_triangles(const PatchScene& scene) {
    for (std::size_t t = 0; t < scene.triangles.size(); ++t) {
        for (std::size_t k = 0; k < 3; ++k)
            if (scene.triangles[t][k] >= scene.positions.size())
                refuse("triangle " + std::to_string(t) + " names position " + std::to_string(scene.triangles[t][k]) +
                       ", but there are only " + std::to_string(scene.positions.size()));
        if (scene.triangle_patch[t] >= scene.patches.size())
            refuse("triangle " + std::to_string(t) + " names patch " + std::to_string(scene.triangle_patch[t]) +
                   ", but there are only " + std::to_string(scene.patches.size()));
        if (!scene.masked(t))
            continue;
        if (std::size_t(scene.triangle_mask[t]) >= scene.masks.size())
            refuse("triangle " + std::to_string(t) + " names alpha mask " + std::to_string(scene.triangle_mask[t]) +
                   ", but there are only " + std::to_string(scene.masks.size()));
        for (std::size_t k = 0; k < 3; ++k) {
            const glm::vec2 uv = scene.uvs[scene.triangles[t][k]];
            if (!std::isfinite(uv.x) || !std::isfinite(uv.y))
                refuse("triangle " + std::to_string(t) + " has an alpha mask, but texture coordinate " +
                       std::to_string(scene.triangles[t][k]) + " is not finite");
        }
    }
}

void validate_patches(const PatchScene& scene) {
    for (std::size_t p = 0; p < scene.patches.size(); ++p) {
        const Patch& patch = scene.patches[p];
        const std::string name = "patch " + std::to_string(p);
        if (std::uint64_t(patch.first_triangle) + patch.triangle_count > scene.triangles.size())
            refuse(name + " ends at triangle " +
                   std::to_string(std::uint64_t(patch.first_triangle) + patch.triangle_count) +
                   ", but there are only " + std::to_string(scene.triangles.size()));
        for (std::uint32_t t = 0; t < patch.triangle_count; ++t)
            if (scene.triangle_patch[patch.first_triangle + t] != p)
                refuse(name + " holds triangle " + std::to_string(patch.first_triangle + t) +
                       ", which says that it belongs to patch " +
                       std::to_string(scene.triangle_patch[patch.first_triangle + t]));
        if (patch.optics >= scene.optics.size())
            refuse(name + " names optics " + std::to_string(patch.optics) + ", but there are only " +
                   std::to_string(scene.optics.size()));
        if (patch.kind == PatchKind::leaf && patch.leaf >= scene.leaf_count)
            refuse(name + " belongs to leaf " + std::to_string(patch.leaf) + ", but there are only " +
                   std::to_string(scene.leaf_count));
    }
}

/// Corners of a masked triangle in texture space: equal keys have equal shares of holes, and foliage cards share
/// theirs.
using MaskKey = std::array<float, 7>;

struct MaskKeyHash {
    std::size_t operator()(const MaskKey& key) const {
        std::uint64_t hash = 0;
        for (const float value : key)
            hash = hash64(hash + std::bit_cast<std::uint32_t>(value + 0.f)); // -0 and 0 are equal
        return std::size_t(hash);
    }
};

MaskKey mask_key(const PatchScene& scene, std::size_t t) {
    const glm::vec2 a = scene.uvs[scene.triangles[t].x], b = scene.uvs[scene.triangles[t].y],
                    c = scene.uvs[scene.triangles[t].z];
    return {float(scene.triangle_mask[t]), a.x, a.y, b.x, b.y, c.x, c.y};
}

/// Side length of the sample lattice: about one sample a texel, within limits.
int lattice_size(const AlphaMask& mask, const MaskKey& key, int limit) {
    const glm::vec2 size(float(mask.alpha->width), float(mask.alpha->height));
    const glm::vec2 a(key[1], key[2]), b(key[3], key[4]), c(key[5], key[6]);
    const float texels =
        std::max({glm::length((b - a) * size), glm::length((c - b) * size), glm::length((a - c) * size)});
    return int(std::clamp(std::ceil(texels), 16.f, float(limit)));
}

/// Share of a triangle that is solid, by the centroids of the n^2 congruent triangles that it falls into.
double solid_share(const AlphaMask& mask, const MaskKey& key, int n) {
    const glm::vec2 a(key[1], key[2]), along_b = glm::vec2(key[3], key[4]) - a, along_c = glm::vec2(key[5], key[6]) - a;
    std::size_t solid = 0;
    for (int i = 0; i < n; ++i)
        for (int j = 0; i + j < n; ++j) {
            solid +=
                mask.solid(a + (float(i) + 1 / 3.f) / float(n) * along_b + (float(j) + 1 / 3.f) / float(n) * along_c);
            if (i + j < n - 1)
                solid += mask.solid(a + (float(i) + 2 / 3.f) / float(n) * along_b +
                                    (float(j) + 2 / 3.f) / float(n) * along_c);
        }
    return double(solid) / (double(n) * n);
}

} // namespace

Bounds bounds_of(const PatchScene& scene) {
    if (scene.triangles.empty())
        return {};
    Bounds bounds{glm::vec3(INFINITY), glm::vec3(-INFINITY)};
    for (const glm::uvec3& triangle : scene.triangles)
        for (std::size_t k = 0; k < 3; ++k) {
            bounds.low = glm::min(bounds.low, scene.positions[triangle[k]]);
            bounds.high = glm::max(bounds.high, scene.positions[triangle[k]]);
        }
    return bounds;
}

std::vector<float> solid_shares(const PatchScene& scene) {
    if (scene.triangle_mask.empty())
        return {};
    std::unordered_map<MaskKey, std::uint32_t, MaskKeyHash> kinds;
    std::vector<MaskKey> keys;
    constexpr std::uint32_t kSolid = ~0u;
    std::vector<std::uint32_t> kind(scene.triangles.size(), kSolid);
    for (std::size_t t = 0; t < scene.triangles.size(); ++t)
        if (scene.masked(t)) {
            const MaskKey key = mask_key(scene, t);
            const auto [entry, is_new] = kinds.try_emplace(key, std::uint32_t(keys.size()));
            if (is_new)
                keys.push_back(key);
            kind[t] = entry->second;
        }
    // A tree with an atlas of its own for every leaf must not cost minutes: at most 5e7 mask look-ups in all.
    const int limit = std::clamp(int(std::sqrt(5e7 / std::max<double>(1, double(keys.size())))), 16, 512);
    std::vector<float> share_of_kind;
    for (const MaskKey& key : keys) {
        const AlphaMask& mask = scene.masks[std::size_t(key[0])];
        share_of_kind.push_back(float(solid_share(mask, key, lattice_size(mask, key, limit))));
    }
    std::vector<float> shares(scene.triangles.size(), 1.f);
    for (std::size_t t = 0; t < shares.size(); ++t)
        if (kind[t] != kSolid)
            shares[t] = share_of_kind[kind[t]];
    return shares;
}

std::vector<double> solid_areas(const PatchScene& scene) {
    const std::vector<float> shares = solid_shares(scene);
    std::vector<double> areas(scene.patches.size(), 0.0);
    for (std::size_t t = 0; t < scene.triangles.size(); ++t) {
        const glm::dvec3 a(scene.positions[scene.triangles[t].x]);
        const double area = 0.5 * glm::length(glm::cross(glm::dvec3(scene.positions[scene.triangles[t].y]) - a,
                                                         glm::dvec3(scene.positions[scene.triangles[t].z]) - a));
        areas[scene.triangle_patch[t]] += shares.empty() ? area : area * double(shares[t]);
    }
    return areas;
}

void validate(const PatchScene& scene) {
    const std::size_t triangles = scene.triangles.size();
    if (scene.triangle_patch.size() != triangles)
        refuse("there are " + std::to_string(triangles) + " triangles, but " +
               std::to_string(scene.triangle_patch.size()) + " patch numbers; give one each");
    if (!scene.triangle_mask.empty() && scene.triangle_mask.size() != triangles)
        refuse("there are " + std::to_string(triangles) + " triangles, but " +
               std::to_string(scene.triangle_mask.size()) + " alpha-mask numbers; give one each, or none");
    if (!scene.uvs.empty() && scene.uvs.size() != scene.positions.size())
        refuse("there are " + std::to_string(scene.positions.size()) + " positions, but " +
               std::to_string(scene.uvs.size()) + " texture coordinates; give one each, or none");
    if (scene.uvs.empty() &&
        std::any_of(scene.triangle_mask.begin(), scene.triangle_mask.end(), [](auto m) { return m >= 0; }))
        refuse("triangles have alpha masks, but there are no texture coordinates");
    for (std::size_t i = 0; i < scene.masks.size(); ++i)
        if (!scene.masks[i].alpha || scene.masks[i].alpha->width < 1 || scene.masks[i].alpha->height < 1)
            refuse("alpha mask " + std::to_string(i) + " has no image");
    for (std::size_t i = 0; i < scene.positions.size(); ++i)
        if (!finite(scene.positions[i]))
            refuse("position " + std::to_string(i) + " is not finite");
    validate_triangles(scene);
    validate_patches(scene);
    validate_optics(scene.optics);
    if (scene.ground) {
        const glm::vec3& albedo = scene.ground->albedo;
        if (!std::isfinite(scene.ground->height_m))
            refuse("the ground's height is not finite");
        if (!(albedo.r >= 0 && albedo.g >= 0 && albedo.b >= 0 && albedo.r <= 1 && albedo.g <= 1 && albedo.b <= 1))
            refuse("the ground's albedo must lie in [0, 1]");
    }
}

} // namespace kokage
