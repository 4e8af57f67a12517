#include "trees/growth/materials.h"

#include "common/services/random.h"
#include "trees/growth/leaves.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <tuple>

namespace kokage {
namespace {

/// Mean reflectance and transmittance of an oak leaf in the three channels: green light 12 % and 10 %, red and blue far
/// less. About what leaf spectra give (Hosgood et al. 1995, LOPEX), in linear Rec.709.
constexpr glm::vec3 leaf_reflectance{0.070f, 0.118f, 0.034f}, leaf_transmittance{0.056f, 0.100f, 0.018f};
constexpr glm::vec3 bark_albedo{0.150f, 0.130f, 0.110f};

/// Value noise on a lattice that repeats after `period` cells, in 0..1.
float tiling_noise(float x, float y, int period_x, int period_y, std::uint64_t seed) {
    const int x0 = int(std::floor(x)), y0 = int(std::floor(y));
    const auto value = [&](int i, int j) {
        const std::uint64_t ix = std::uint64_t(((i % period_x) + period_x) % period_x),
                            iy = std::uint64_t(((j % period_y) + period_y) % period_y);
        return float(hash64(seed ^ (ix << 32) ^ iy) >> 40) * 0x1p-24f;
    };
    const auto smooth = [](float t) { return t * t * (3 - 2 * t); };
    const float tx = smooth(x - float(x0)), ty = smooth(y - float(y0));
    const float low = value(x0, y0) + tx * (value(x0 + 1, y0) - value(x0, y0));
    const float high = value(x0, y0 + 1) + tx * (value(x0 + 1, y0 + 1) - value(x0, y0 + 1));
    return low + ty * (high - low);
}

/// Scales a texture so that the mean over the pixels with weight is `mean`.
void set_mean(Image& image, const Image* weight, const glm::vec3& mean) {
    glm::dvec3 sum(0.0);
    double total = 0;
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            const double w = weight ? double(weight->at(x, y)[0]) : 1.0;
            sum += w * glm::dvec3(image.at(x, y)[0], image.at(x, y)[1], image.at(x, y)[2]);
            total += w;
        }
    for (int i = 0; i < image.width * image.height; ++i)
        for (std::size_t c = 0; c < 3; ++c)
            image.pixels[std::size_t(i) * 3 + c] =
                std::min(1.f, float(double(image.pixels[std::size_t(i) * 3 + c]) * mean[c] * total / sum[c]));
}

constexpr int leaf_size = 128, bark_size = 256;

std::shared_ptr<const Image> leaf_alpha(const glm::vec3&) {
    auto alpha = std::make_shared<Image>(leaf_size, leaf_size, 1);
    for (int y = 0; y < leaf_size; ++y)
        for (int x = 0; x < leaf_size; ++x) {
            int inside = 0;
            for (int row = 0; row < 4; ++row)
                for (int column = 0; column < 4; ++column)
                    inside += inside_leaf_shape({(float(x) + (float(column) + 0.5f) / 4) / float(leaf_size),
                                                 (float(y) + (float(row) + 0.5f) / 4) / float(leaf_size)});
            alpha->at(x, y)[0] = float(inside) / 16;
        }
    return alpha;
}

/// Green with a paler midrib and side veins that run into the lobes, and a little mottling.
std::shared_ptr<const Image> leaf_color(const glm::vec3& mean) {
    auto image = std::make_shared<Image>(leaf_size, leaf_size, 3);
    for (int py = 0; py < leaf_size; ++py)
        for (int px = 0; px < leaf_size; ++px) {
            const float u = std::abs((float(px) + 0.5f) / float(leaf_size) - 0.5f),
                        y = 1 - (float(py) + 0.5f) / float(leaf_size);
            const float midrib = std::exp(-std::pow(u / (0.012f + 0.012f * (1 - y)), 2.f));
            const float along_vein = 4 * (y - 0.55f * u); // veins rise from the midrib, one into each lobe
            const float off_vein = std::abs(along_vein - std::round(along_vein)) / 4;
            const float vein = 0.6f * std::exp(-std::pow(off_vein / 0.009f, 2.f));
            const float mottle = 0.86f + 0.28f * tiling_noise(float(px) / 6, float(py) / 6, 64, 64, 11);
            const float pale = std::max(midrib, vein);
            const glm::vec3 color = mottle * glm::mix(glm::vec3(1.f), glm::vec3(2.1f, 1.6f, 2.6f), pale) * mean;
            for (std::size_t c = 0; c < 3; ++c)
                image->at(px, py)[c] = color[c];
        }
    set_mean(*image, leaf_alpha({}).get(), mean);
    return image;
}

/// Grey ridges between dark fissures that run along the branch (v) and split and join, as old oak bark does.
std::shared_ptr<const Image> bark_color(const glm::vec3& mean) {
    auto image = std::make_shared<Image>(bark_size, bark_size, 3);
    for (int y = 0; y < bark_size; ++y)
        for (int x = 0; x < bark_size; ++x) {
            const float u = float(x) / float(bark_size), v = float(y) / float(bark_size);
            const float bend =
                0.9f * tiling_noise(u * 5, v * 4, 5, 4, 21) + 0.45f * tiling_noise(u * 12, v * 9, 12, 9, 22);
            const float stripes = std::abs(std::sin(kPi * (9 * u + bend * 1.6f))); // 0 in a fissure
            const float cross = std::abs(std::sin(kPi * (5 * v + 2.2f * tiling_noise(u * 9, v * 3, 9, 3, 23))));
            const float ridge = std::min(std::pow(stripes, 0.6f), 0.35f + 0.65f * std::pow(cross, 0.35f));
            const float grain = tiling_noise(u * 64, v * 24, 64, 24, 24), lichen = tiling_noise(u * 7, v * 7, 7, 7, 25);
            const float light = 0.28f + 0.8f * ridge + 0.35f * (grain - 0.5f);
            const glm::vec3 tint = glm::mix(glm::vec3(1.f, 0.95f, 0.9f), glm::vec3(0.88f, 1.f, 0.86f),
                                            std::clamp(3 * (lichen - 0.6f), 0.f, 1.f));
            const glm::vec3 color = std::max(0.08f, light) * tint;
            for (std::size_t c = 0; c < 3; ++c)
                image->at(x, y)[c] = color[c];
        }
    set_mean(*image, nullptr, mean);
    return image;
}

/// Textures of the same mean colour are the same: they are drawn once.
using Drawing = std::shared_ptr<const Image> (*)(const glm::vec3&);
std::shared_ptr<const Image> drawn_once(Drawing draw, const glm::vec3& mean) {
    static std::mutex mutex;
    static std::map<std::tuple<Drawing, float, float, float>, std::shared_ptr<const Image>> drawn;
    const std::lock_guard lock(mutex);
    std::shared_ptr<const Image>& image = drawn[{draw, mean.r, mean.g, mean.b}];
    if (!image)
        image = draw(mean);
    return image;
}

} // namespace

TreeMaterial leaf_material(const GrowthParameters& p) {
    TreeMaterial material;
    material.name = p.species + " leaf";
    // rho = (1 - f) base, tau = f transmission colour; f is the same for all channels, the colours make up the rest.
    const float f = 0.45f;
    material.diffuse_transmission = f;
    material.diffuse_transmission_color = leaf_transmittance / f;
    material.base_color = leaf_reflectance / (1 - f);
    material.roughness = 0.6f;
    material.wrap_u = material.wrap_v = TextureWrap::clamp;
    if (p.leaf_form == LeafForm::alpha)
        material.alpha_texture = drawn_once(leaf_alpha, glm::vec3(0.f));
    if (p.textures) {
        material.base_color_texture = drawn_once(leaf_color, material.base_color);
        material.base_color = glm::vec3(1.f);
    }
    return material;
}

TreeMaterial bark_material(const GrowthParameters& p) {
    TreeMaterial material;
    material.name = p.species + " bark";
    material.double_sided = false;
    material.roughness = 0.95f;
    material.base_color = bark_albedo;
    if (p.textures) {
        material.base_color_texture = drawn_once(bark_color, bark_albedo);
        material.base_color = glm::vec3(1.f);
    }
    return material;
}

} // namespace kokage
