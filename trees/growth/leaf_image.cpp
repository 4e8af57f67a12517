#include "trees/growth/leaf_image.h"

#include "trees/growth/leaf_shape.h"
#include "trees/growth/tiling_noise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <mutex>
#include <string>

namespace kokage {
namespace {

constexpr int blade_size = 128, spray_size = 256;

/// Where a row at height y crosses the right edge of a blade, in order.
std::vector<float> crossings(const HalfOutline& half, float y) {
    std::vector<float> xs;
    for (std::size_t i = 0; i + 1 < half.size(); ++i)
        if ((half[i].y <= y) != (half[i + 1].y <= y))
            xs.push_back(half[i].x + (y - half[i].y) / (half[i + 1].y - half[i].y) * (half[i + 1].x - half[i].x));
    std::sort(xs.begin(), xs.end());
    return xs;
}

/// The blade's outline, from four rows a texel and exact spans along them.
Image blade_mask(const HalfOutline& half) {
    constexpr int rows = 4;
    Image mask(blade_size, blade_size, 1);
    for (int y = 0; y < blade_size; ++y)
        for (int row = 0; row < rows; ++row) {
            const float at = 1 - (float(y) + (float(row) + 0.5f) / rows) / blade_size;
            std::vector<float> xs = crossings(half, at);
            // The midrib is the blade's inside at heights where the edge is crossed an odd number of times.
            if (xs.size() % 2 == 1)
                xs.insert(xs.begin(), 0.f);
            for (std::size_t k = 0; k + 1 < xs.size(); k += 2)
                for (int x = 0; x < blade_size; ++x) {
                    // Texels of the left half mirror those of the right.
                    const int right = x < blade_size / 2 ? blade_size - 1 - x : x;
                    const float low = float(right) / blade_size - 0.5f, high = low + 1.f / blade_size;
                    const float inside = std::min(high, xs[k + 1]) - std::max(low, xs[k]);
                    mask.at(x, y)[0] += std::max(0.f, inside) * blade_size / rows;
                }
        }
    return mask;
}

/// How much of a texel lies inside a segment, by its centre's distance to the edge.
void draw_segment(Image& mask, const SpraySegment& segment, float width, bool as_card) {
    const float size = float(mask.width);
    // Texels per unit across and along differ: distances are taken in units of the spray's length.
    const auto texel = [&](const glm::vec2& p) { return glm::vec2((p.x / width + 0.5f) * size, (1 - p.y) * size); };
    const glm::vec2 base(segment.base), tip(segment.tip), along = tip - base;
    const float length = std::max(glm::length(along), 1e-6f), texel_length = std::max(width, 1.f) / size;
    const float reach = segment.half_width + texel_length;
    const glm::vec2 a = texel(glm::min(base, tip) - glm::vec2(reach)),
                    b = texel(glm::max(base, tip) + glm::vec2(reach));
    const int x0 = std::max(0, int(std::min(a.x, b.x))), x1 = std::min(mask.width - 1, int(std::max(a.x, b.x)));
    const int y0 = std::max(0, int(std::min(a.y, b.y))), y1 = std::min(mask.height - 1, int(std::max(a.y, b.y)));
    // Needles thinner than a texel keep a texel's width in cards, so that they don't tear.
    const float thinnest = as_card ? 0.6f * texel_length : 0.f;
    for (int y = y0; y <= y1; ++y)
        for (int x = x0; x <= x1; ++x) {
            const glm::vec2 p{((float(x) + 0.5f) / size - 0.5f) * width, 1 - (float(y) + 0.5f) / size};
            const float t = std::clamp(glm::dot(p - base, along) / (length * length), 0.f, 1.f);
            const float taper = segment.is_petal
                                    ? std::sqrt(std::max(0.f, 1 - std::pow(std::abs(2 * t - 1.15f) / 1.15f, 2.5f)))
                                    : std::min(1.f, 6 * (1 - t) + 0.35f);
            const float half = std::max(segment.half_width * taper, thinnest);
            const float inside = std::clamp(0.5f + (half - glm::length(p - base - t * along)) / texel_length, 0.f, 1.f);
            mask.at(x, y)[0] = std::max(mask.at(x, y)[0], inside);
        }
}

Image spray_mask(const Spray& spray, float width) {
    Image mask(spray_size, spray_size, 1);
    for (std::size_t i = 0; i < spray.first_half; ++i)
        draw_segment(mask, spray.segments[i], width, true);
    return mask;
}

/// Scales a texture so that the mean over the texels with weight is `mean`.
void set_mean(Image& image, const Image& weight, const glm::vec3& mean) {
    glm::dvec3 sum(0.0);
    double total = 0;
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            const double w = double(weight.at(x * weight.width / image.width, y * weight.height / image.height)[0]);
            sum += w * glm::dvec3(image.at(x, y)[0], image.at(x, y)[1], image.at(x, y)[2]);
            total += w;
        }
    for (int i = 0; i < image.width * image.height; ++i)
        for (std::size_t c = 0; c < 3; ++c)
            image.pixels[std::size_t(i) * 3 + c] =
                std::min(1.f, float(double(image.pixels[std::size_t(i) * 3 + c]) * mean[c] * total / sum[c]));
}

float bump(float distance, float width) {
    return std::exp(-distance * distance / (width * width));
}

/// 1 on a vein, 0 between them. u: distance from the midrib, 0..0.5.
float vein_strength(const Venation& veins, float u, float y) {
    const float midrib = bump(u, 0.012f + 0.012f * (1 - y));
    if (veins.is_palmate) { // to the tips of the side lobes and the basal lobes
        float strongest = midrib;
        for (const glm::vec2& lobe : {glm::vec2(0.5f, 0.57f), glm::vec2(0.43f, 0.04f)}) {
            const glm::vec2 direction = glm::normalize(lobe), p(u, y - 0.08f);
            const float t = glm::dot(p, direction);
            if (t > 0)
                strongest = std::max(strongest, bump(glm::length(p - t * direction), 0.012f) * (1 - 0.4f * t));
        }
        return strongest;
    }
    const float along = float(veins.pairs) * (y - veins.rise * u);
    const float off = std::abs(along - std::round(along)) / float(veins.pairs);
    return std::max(midrib, 0.6f * bump(off, std::min(0.009f, 0.06f / float(veins.pairs))));
}

/// Colour of a blade, to be scaled to its mean.
Image blade_color(const GrowthParameters& p, const glm::vec3& mean) {
    const Venation veins = venation(p.leaf_shape);
    const bool turning = p.season == Season::autumn;
    Image image(blade_size, blade_size, 3);
    for (int py = 0; py < blade_size; ++py)
        for (int px = 0; px < blade_size; ++px) {
            const float u = std::abs((float(px) + 0.5f) / blade_size - 0.5f), y = 1 - (float(py) + 0.5f) / blade_size;
            const float pale = vein_strength(veins, u, y);
            const float mottle = 0.86f + 0.28f * tiling_noise(float(px) / 6, float(py) / 6, 64, 64, 11);
            glm::vec3 color = mottle * glm::mix(glm::vec3(1.f), glm::vec3(2.1f, 1.6f, 2.6f), pale) * mean;
            if (turning) { // green goes last along the veins; edges redden first
                const float patch = tiling_noise(float(px) / 20, float(py) / 20, 16, 16, 12);
                const float edge = std::clamp(1.6f * u + 0.5f * patch, 0.f, 1.f);
                color = mottle * glm::mix(glm::vec3(0.95f, 1.25f, 1.1f), glm::vec3(1.03f, 0.78f, 0.9f), edge) *
                        glm::mix(glm::vec3(1.f), glm::vec3(1.05f, 1.3f, 1.6f), pale) * mean;
            }
            for (std::size_t c = 0; c < 3; ++c)
                image.at(px, py)[c] = color[c];
        }
    return image;
}

/// Colour of a spray: needles that vary, the twig brown; petals paler outwards, red at the heart.
Image spray_color(const GrowthParameters& p, const Spray& spray, const glm::vec3& mean) {
    Image image(spray_size, spray_size, 3);
    const bool blossom = is_in_blossom(p);
    Image wood(spray_size, spray_size, 1);
    for (std::size_t i = 0; i < spray.first_half && !blossom; ++i)
        if (spray.segments[i].is_wood)
            draw_segment(wood, spray.segments[i], float(p.leaf_width), false);
    for (int y = 0; y < spray_size; ++y)
        for (int x = 0; x < spray_size; ++x) {
            const float along = 1 - (float(y) + 0.5f) / spray_size;
            float vary = 0.75f + 0.5f * tiling_noise(float(x) / 5, float(y) / 5, 64, 64, 13);
            glm::vec3 tint(1.f);
            if (blossom) {
                float heart = 1e9f, vein = 0;
                const glm::vec2 at{((float(x) + 0.5f) / spray_size - 0.5f) * float(p.leaf_width), along};
                for (const SpraySegment& segment : spray.segments)
                    if (segment.is_petal) {
                        // Petals are palest in the middle: each shows beside its neighbours.
                        const glm::vec2 from = at - glm::vec2(segment.base), along_petal(segment.tip - segment.base);
                        heart = std::min(heart, glm::length(from));
                        const float t = glm::dot(from, along_petal) / glm::dot(along_petal, along_petal);
                        if (t > 0 && t < 1.05f)
                            vein = std::max(vein, bump(glm::length(from - t * along_petal), 0.6f * segment.half_width));
                    }
                vary = 0.72f + 0.28f * vein + 0.08f * (vary - 1);
                tint = glm::mix(glm::vec3(0.95f, 0.5f, 0.6f), glm::vec3(1.f), std::min(1.f, heart / 0.06f));
            } else if (p.season == Season::spring) { // this year's growth at the tip
                tint = glm::mix(glm::vec3(0.8f), glm::vec3(1.5f, 1.45f, 1.1f), std::clamp(3 * along - 1.6f, 0.f, 1.f));
            }
            const glm::vec3 brown{0.13f, 0.085f, 0.045f};
            const glm::vec3 color = glm::mix(vary * tint * mean, brown, wood.at(x, y)[0]);
            for (std::size_t c = 0; c < 3; ++c)
                image.at(x, y)[c] = color[c];
        }
    return image;
}

/// What an image depends on; images are drawn once and kept.
struct ImageKey {
    std::array<int, 4> kinds;
    std::array<float, 4> numbers;
    auto operator<=>(const ImageKey&) const = default;
};
ImageKey key_of(const GrowthParameters& p, int what, const glm::vec3& mean) {
    const bool spray = leaf_spray(p).has_value();
    // Blades look alike in all seasons but autumn, whose pattern differs; their mean is in the key.
    const int look = is_in_blossom(p) ? 1 : p.season == Season::autumn ? 2 : p.season == Season::spring ? 3 : 0;
    return {{what, int(p.leaf_shape), look, spray ? p.needles : 0},
            {mean.r, mean.g, mean.b, spray ? float(p.leaf_width) : 0.f}};
}
std::shared_ptr<const Image> drawn_once(const ImageKey& key, const std::function<Image()>& draw) {
    static std::mutex mutex;
    static std::map<ImageKey, std::shared_ptr<const Image>> drawn;
    const std::lock_guard lock(mutex);
    if (drawn.size() > 256) // someone tries out many shapes: what is in use stays with its tree
        drawn.clear();
    std::shared_ptr<const Image>& image = drawn[key];
    if (!image)
        image = std::make_shared<Image>(draw());
    return image;
}

} // namespace

std::shared_ptr<const Image> leaf_mask(const GrowthParameters& p) {
    return drawn_once(key_of(p, 0, glm::vec3(0)), [&] {
        const std::optional<Spray> spray = leaf_spray(p);
        return spray ? spray_mask(*spray, float(p.leaf_width)) : blade_mask(mask_outline(p.leaf_shape));
    });
}

double solid_share(const Image& mask, float cutoff) {
    std::size_t solid = 0;
    for (const float alpha : mask.pixels)
        solid += alpha >= cutoff;
    return mask.pixels.empty() ? 1.0 : double(solid) / double(mask.pixels.size());
}

std::shared_ptr<const Image> leaf_color(const GrowthParameters& p, const glm::vec3& mean) {
    const std::shared_ptr<const Image> mask = leaf_mask(p);
    return drawn_once(key_of(p, 1, mean), [&] {
        const std::optional<Spray> spray = leaf_spray(p);
        Image image = spray ? spray_color(p, *spray, mean) : blade_color(p, mean);
        set_mean(image, *mask, mean);
        return image;
    });
}

} // namespace kokage
