#include "tests/benchmark/render_truth_hash.h"
#include "common/services/random.h"
#include "tests/benchmark/scene_hash.h"

#include <array>
#include <cstdio>
#include <map>

namespace kokage {
namespace {

/// Raise it when path tracing of pictures means something else than before: stored truths are then of no more use.
constexpr std::uint64_t kModel = 1;

class TruthHasher {
  public:
    void add(std::uint64_t value) { state_ = hash64(state_ ^ hash64(value)); }
    void add_rounded(double value) {
        char digits[32];
        std::snprintf(digits, sizeof digits, "%.4e", value == 0 ? 0. : value);
        for (const char* c = digits; *c; ++c)
            add(std::uint64_t(static_cast<unsigned char>(*c)));
    }
    std::uint64_t value() const { return state_; }

  private:
    std::uint64_t state_ = 0x7069637475726573ull;
};

/// Four sums of all numbers of a kind, each number with weights of its own.
class WeightedSums {
  public:
    void add(double value) {
        const std::uint64_t bits = hash64(count_++);
        for (std::size_t k = 0; k < sums_.size(); ++k)
            sums_[k] += value * (double((bits >> (16 * k)) & 0xffff) / 32767.5 - 1);
    }
    void add(const glm::vec2& v) {
        add(double(v.x));
        add(double(v.y));
    }
    void add(const glm::vec3& v) {
        add(double(v.x));
        add(double(v.y));
        add(double(v.z));
    }
    void finish(TruthHasher& hasher) const {
        hasher.add(count_);
        for (const double sum : sums_)
            hasher.add_rounded(sum);
    }

  private:
    std::uint64_t count_ = 0;
    std::array<double, 4> sums_{};
};

template <typename Values>
void add_all(TruthHasher& hasher, const Values& values) {
    WeightedSums sums;
    for (const auto& value : values)
        sums.add(value);
    sums.finish(hasher);
}

void add_indices(TruthHasher& hasher, const std::vector<std::uint32_t>& indices) {
    hasher.add(std::uint64_t(indices.size()));
    for (const std::uint32_t index : indices)
        hasher.add(std::uint64_t(index));
}

/// Images and height fields are shared by looks: each is summed once.
class SharedNumbers {
  public:
    void add(TruthHasher& hasher, const std::shared_ptr<const Image>& image) {
        if (image)
            hasher.add(of(image.get(), image->pixels) + std::uint64_t(image->width));
    }
    void add(TruthHasher& hasher, const std::shared_ptr<const HeightField>& heights) {
        if (heights)
            hasher.add(of(heights.get(), heights->depths));
    }

  private:
    std::uint64_t of(const void* key, const std::vector<float>& numbers) {
        const auto [entry, is_new] = known_.try_emplace(key, 0);
        if (is_new) {
            TruthHasher hasher;
            add_all(hasher, numbers);
            entry->second = hasher.value();
        }
        return entry->second;
    }
    std::map<const void*, std::uint64_t> known_;
};

void add_looks(TruthHasher& hasher, const std::vector<SurfaceLook>& looks) {
    SharedNumbers shared;
    WeightedSums sums;
    for (const SurfaceLook& look : looks) {
        sums.add(look.base_color);
        sums.add(look.mean_base_color);
        sums.add(look.gloss.normal_reflectance);
        sums.add(look.gloss.tinted_reflectance);
        sums.add(double(look.gloss.roughness));
        const RoughnessGradient gradient = look.gloss.roughness_gradient.value_or(RoughnessGradient{0, 0, 0, 0});
        for (const float x : {gradient.foot_height, gradient.top_height, gradient.foot, gradient.top,
                              look.relief.depth_m, look.relief.tile_m})
            sums.add(double(x));
        shared.add(hasher, look.base_color_texture);
        shared.add(hasher, look.gloss.roughness_texture);
        shared.add(hasher, look.relief.heights);
        hasher.add(16 * std::uint64_t(look.wrap_u) + 4 * std::uint64_t(look.wrap_v) + look.smooth_normals);
    }
    sums.finish(hasher);
}

void add_patches(TruthHasher& hasher, const PatchScene& scene) {
    add_all(hasher, scene.positions);
    add_all(hasher, scene.uvs);
    for (const glm::uvec3& triangle : scene.triangles)
        hasher.add(std::uint64_t(triangle.x) << 42 ^ std::uint64_t(triangle.y) << 21 ^ triangle.z);
    for (const std::int16_t mask : scene.triangle_mask)
        hasher.add(std::uint64_t(std::uint16_t(mask)));
    for (const AlphaMask& mask : scene.masks) {
        hasher.add_rounded(double(mask.cutoff));
        hasher.add(std::uint64_t(mask.wrap_u) * 4 + std::uint64_t(mask.wrap_v));
        if (mask.alpha)
            add_all(hasher, mask.alpha->pixels);
    }
    WeightedSums optics;
    for (const Patch& patch : scene.patches) {
        hasher.add(std::uint64_t(patch.first_triangle) << 1 ^ std::uint64_t(patch.kind));
        optics.add(scene.optics[patch.optics].reflectance);
        optics.add(scene.optics[patch.optics].transmittance);
    }
    optics.finish(hasher);
}

/// In one sum: a height that is almost 0 would have no digits to be rounded to.
void add_view(TruthHasher& hasher, const AssembledScene& scene) {
    const Ground ground = scene.patches.ground.value_or(Ground{0, glm::vec3(-1.f)});
    WeightedSums sums;
    for (const glm::vec3& v : {scene.camera.position, scene.camera.target, scene.camera.up, ground.albedo})
        sums.add(v);
    for (const float x : {scene.camera.vertical_field_of_view, scene.foot_height, ground.height_m})
        sums.add(double(x));
    sums.finish(hasher);
}

} // namespace

std::uint64_t picture_hash(const AssembledScene& scene, const PictureOptions& picture) {
    TruthHasher hasher;
    hasher.add(kModel);
    add_patches(hasher, scene.patches);
    add_all(hasher, scene.origins.normals);
    add_looks(hasher, scene.looks);
    add_indices(hasher, scene.triangle_look);
    hasher.add(environment_hash(scene.environment));
    add_view(hasher, scene);
    for (const int x : {picture.width, picture.height, picture.every_row, picture.every_column, int(picture.ground)})
        hasher.add(std::uint64_t(x));
    return hasher.value();
}

} // namespace kokage
