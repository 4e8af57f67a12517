#include "tests/benchmark/scene_hash.h"
#include "common/services/random.h"

#include <bit>
#include <cmath>
#include <cstdio>
#include <string>

namespace kokage {

namespace {

class Hasher {
  public:
    void add(std::uint64_t value) { state_ = hash64(state_ ^ hash64(value)); }
    void add(float value) { add(std::uint64_t(std::bit_cast<std::uint32_t>(value == 0.f ? 0.f : value))); }
    void add(const glm::vec3& v) {
        add(v.x);
        add(v.y);
        add(v.z);
    }
    /// A number of which only 5 digits count.
    void add_rounded(double value) {
        char digits[32];
        std::snprintf(digits, sizeof digits, "%.4e", value);
        for (const char* c = digits; *c; ++c)
            add(std::uint64_t(static_cast<unsigned char>(*c)));
    }
    std::uint64_t value() const { return state_; }

  private:
    std::uint64_t state_ = 0x6b6f6b616765ull;
};

void add_mask(Hasher& hasher, const AlphaMask& mask) {
    hasher.add(mask.cutoff);
    hasher.add(std::uint64_t(mask.wrap_u) * 4 + std::uint64_t(mask.wrap_v));
    if (!mask.alpha)
        return;
    hasher.add(std::uint64_t(mask.alpha->width));
    hasher.add(std::uint64_t(mask.alpha->height));
    for (float alpha : mask.alpha->pixels)
        hasher.add(alpha);
}

/// Between 0.5 and 1.5, of a key.
double weight(std::uint64_t key) {
    return 0.5 + double(hash64(key) >> 11) * 0x1p-53;
}

/// A sum over everything in the environment, each number with its own weight.
double weighted_sum(const Environment& environment, std::uint64_t which) {
    double sum = 0;
    std::uint64_t key = which << 48;
    const auto add = [&](const glm::vec3& energy, const glm::vec3& place, double width) {
        for (glm::length_t i = 0; i < 3; ++i, key += 5)
            sum += double(energy[i]) * (weight(key) + weight(key + 1) * place.x + weight(key + 2) * place.y +
                                        weight(key + 3) * place.z + weight(key + 4) * width);
    };
    const Image& image = environment.remainder;
    for (int y = 0; y < image.height; ++y) {
        const double solid_angle = pixel_solid_angle(y, image.width, image.height);
        for (int x = 0; x < image.width; ++x)
            for (int c = 0; c < 3; ++c)
                sum += solid_angle * weight(key++) * image.at(x, y)[c];
    }
    for (const DistantLight& light : environment.distant_lights) {
        add(light.irradiance, light.direction, light.half_angle);
        for (const DistantLight::Texel& texel : light.texels)
            add(texel.irradiance, texel.direction, texel.half_angle);
    }
    for (const PointLight& light : environment.point_lights)
        add(light.intensity, light.position, 0.0);
    return sum;
}

} // namespace

std::uint64_t geometry_hash(const PatchScene& scene) {
    Hasher hasher;
    hasher.add(std::uint64_t(scene.leaf_count));
    for (const Patch& patch : scene.patches) {
        const Optics& optics = scene.optics.at(patch.optics);
        if (patch.kind == PatchKind::leaf)
            hasher.add(std::uint64_t(patch.leaf));
        for (std::uint32_t t = patch.first_triangle; t < patch.first_triangle + patch.triangle_count; ++t) {
            hasher.add(optics.reflectance);
            hasher.add(optics.transmittance);
            for (glm::length_t corner = 0; corner < 3; ++corner) {
                const std::uint32_t index = scene.triangles[t][corner];
                hasher.add(scene.positions[index]);
                if (scene.masked(t)) {
                    hasher.add(scene.uvs[index].x);
                    hasher.add(scene.uvs[index].y);
                }
            }
            if (scene.masked(t))
                hasher.add(std::uint64_t(scene.triangle_mask[t]));
        }
    }
    for (const AlphaMask& mask : scene.masks)
        add_mask(hasher, mask);
    if (scene.ground) {
        hasher.add(scene.ground->height_m);
        hasher.add(scene.ground->albedo);
    }
    return hasher.value();
}

std::uint64_t environment_hash(const Environment& environment) {
    Hasher hasher;
    hasher.add(std::uint64_t(environment.has_lower_half));
    hasher.add(std::uint64_t(environment.distant_lights.size()));
    hasher.add(std::uint64_t(environment.point_lights.size()));
    for (std::uint64_t which = 1; which <= 24; ++which)
        hasher.add_rounded(weighted_sum(environment, which));
    return hasher.value();
}

} // namespace kokage
