// Optics of a tree's materials (declared in trees/patches.h).
#include "trees/patches.h"

#include "common/services/random.h"

#include <algorithm>
#include <cmath>

namespace kokage {
namespace {

glm::vec3 clamped_color(const glm::vec3& color) {
    const auto clamp = [](float x) { return x > 0.f ? std::min(x, 1.f) : 0.f; }; // NaN becomes 0
    return {clamp(color.r), clamp(color.g), clamp(color.b)};
}

float wrapped(float coordinate, TextureWrap wrap) {
    if (!std::isfinite(coordinate))
        return 0.f;
    if (wrap == TextureWrap::clamp)
        return std::clamp(coordinate, 0.f, 1.f);
    if (wrap == TextureWrap::mirror) {
        const float t = coordinate - 2.f * std::floor(coordinate * 0.5f);
        return t > 1.f ? 2.f - t : t;
    }
    return coordinate - std::floor(coordinate);
}

/// The nearest texel of an image for texture coordinates of any value.
const float* texel(const Image& image, glm::vec2 uv, const TreeMaterial& material) {
    const int x = int(wrapped(uv.x, material.wrap_u) * float(image.width));
    const int y = int(wrapped(uv.y, material.wrap_v) * float(image.height));
    return image.at(std::clamp(x, 0, image.width - 1), std::clamp(y, 0, image.height - 1));
}

bool has_pixels(const std::shared_ptr<const Image>& image) {
    return image && !image->empty();
}

/// Sums colour by weight x alpha, and by weight alone for surfaces that are holes everywhere.
struct ColorMean {
    glm::dvec3 sum{0.0}, plain_sum{0.0};
    double weight = 0, plain_weight = 0;

    void add(const TreeMaterial& material, glm::vec2 uv, double w) {
        const float* pixel = texel(*material.base_color_texture, uv, material);
        const glm::dvec3 color(clamped_color({pixel[0], pixel[1], pixel[2]}));
        double alpha =
            has_pixels(material.alpha_texture) ? double(texel(*material.alpha_texture, uv, material)[0]) : 1.0;
        alpha = alpha > 0 ? std::min(alpha, 1.0) : 0.0;
        sum += w * alpha * color;
        weight += w * alpha;
        plain_sum += w * color;
        plain_weight += w;
    }
    glm::vec3 mean() const {
        if (weight > 0)
            return glm::vec3(sum / weight);
        return plain_weight > 0 ? glm::vec3(plain_sum / plain_weight) : glm::vec3(1.f);
    }
};

glm::vec3 whole_texture_mean(const TreeMaterial& material) {
    if (!has_pixels(material.base_color_texture))
        return glm::vec3(1.f);
    ColorMean mean;
    const Image& image = *material.base_color_texture;
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            mean.add(material, {(float(x) + 0.5f) / float(image.width), (float(y) + 0.5f) / float(image.height)}, 1);
    return mean.mean();
}

/// Points of a triangle, spread evenly: the R2 sequence (Roberts 2018) folded into the triangle. Which points depends
/// on `start` alone, so that together the triangles of a card cover its texture.
template <class Visit>
void for_points_of_triangle(std::size_t start, int count, Visit visit) {
    for (int i = 0; i < count; ++i) {
        const double n = double(start) * count + i + 1;
        double a = std::fmod(0.7548776662466927 * n, 1.0), b = std::fmod(0.5698402909980532 * n, 1.0);
        if (a + b > 1) {
            a = 1 - a;
            b = 1 - b;
        }
        visit(float(a), float(b));
    }
}

double triangle_area(const TreePart& part, const glm::uvec3& t) {
    const glm::dvec3 a(part.positions[t.x]), b(part.positions[t.y]), c(part.positions[t.z]);
    return 0.5 * glm::length(glm::cross(b - a, c - a));
}

} // namespace

glm::vec3 mean_base_color(const Tree& tree, std::uint32_t material_index, TreePartKind kind) {
    const TreeMaterial& material = tree.materials.at(material_index);
    const glm::vec3 factor = clamped_color(material.base_color);
    if (!has_pixels(material.base_color_texture))
        return factor;
    std::size_t triangles = 0;
    const auto counts = [&](const TreePart& part) {
        return part.kind == kind && part.material == material_index && !part.uvs.empty();
    };
    for (const TreePart& part : tree.parts)
        triangles += counts(part) ? part.triangles.size() : 0;
    if (triangles == 0)
        return factor * whole_texture_mean(material);
    // About 50,000 points in all: some on every triangle of a small mesh, on one of every so many of a large one. Which
    // one is random: leaves repeat their triangles, and equal steps could meet the same ones again and again.
    constexpr std::size_t points = 50000;
    const std::size_t stride = std::max<std::size_t>(1, triangles / (points / 8));
    const int points_per_triangle = int(std::clamp<std::size_t>(points / triangles, 8, 16384));
    ColorMean mean;
    std::size_t index = 0;
    for (const TreePart& part : tree.parts) {
        if (!counts(part))
            continue;
        for (const glm::uvec3& t : part.triangles) {
            const std::size_t here = index++;
            if (here % stride != hash64(here / stride) % stride)
                continue;
            const double area = triangle_area(part, t);
            if (!(area > 0) || !std::isfinite(area))
                continue;
            const glm::vec2 uv = part.uvs[t.x], along = part.uvs[t.y] - uv, across = part.uvs[t.z] - uv;
            for_points_of_triangle(here, points_per_triangle,
                                   [&](float a, float b) { mean.add(material, uv + a * along + b * across, area); });
        }
    }
    return factor * (mean.plain_weight > 0 ? mean.mean() : whole_texture_mean(material));
}

Optics optics_of(const TreeMaterial& material, TreePartKind kind, const glm::vec3& mean) {
    const glm::vec3 base = clamped_color(mean);
    if (kind == TreePartKind::bark)
        return {base, glm::vec3(0.f)};
    Optics optics;
    float limit = 1.f;
    if (material.diffuse_transmission >= 0) {
        const float f = std::min(material.diffuse_transmission, 1.f);
        optics.reflectance = (1 - f) * base;
        optics.transmittance = f * clamped_color(material.diffuse_transmission_color);
    } else {
        optics.reflectance = base;
        optics.transmittance = 0.8f * base;
        limit = 0.95f;
    }
    const glm::vec3 sum = optics.reflectance + optics.transmittance;
    const float largest = std::max({sum.r, sum.g, sum.b});
    if (largest > limit) {
        optics.reflectance *= limit / largest;
        optics.transmittance *= limit / largest;
    }
    return optics;
}

Optics optics_of(const TreeMaterial& material, TreePartKind kind) {
    return optics_of(material, kind, clamped_color(material.base_color) * whole_texture_mean(material));
}

} // namespace kokage
