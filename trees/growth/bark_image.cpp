#include "trees/growth/bark_image.h"

#include "common/services/parallel.h"
#include "trees/growth/bark_patterns.h"

#include <algorithm>
#include <array>
#include <stdexcept>

namespace kokage {
namespace {

struct BarkMeasures {
    glm::vec3 twig, young, old; ///< mean colours; `old` is not used where bark turns with age: its pattern holds both
    float young_depth_m, old_depth_m, roughness;
};

// Mean colours are ours, ordered as measured bark is: birch brightest by far, then aspen and beech, grey and brown
// barks between 0.1 and 0.2 with red above blue, spruce darkest (Juola, Hovi and Rautiainen 2020, Silva Fennica 54(4)
// 10331; 2022, Ecology and Evolution 12:e8718). The oak's is the one that this program began with. Depths: field
// guides' "smooth" is taken as 1 to 2 mm, "deeply fissured" as 15 to 30 mm.
constexpr std::array<BarkMeasures, 10> measures = {{
    {{0.170f, 0.140f, 0.100f}, {0.170f, 0.155f, 0.130f}, {0.150f, 0.130f, 0.110f}, 0.006f, 0.022f, 0.95f}, // oak
    {{0.130f, 0.108f, 0.088f}, {0.250f, 0.245f, 0.220f}, {0.235f, 0.230f, 0.205f}, 0.001f, 0.002f, 0.85f}, // beech
    {{0.085f, 0.056f, 0.045f}, {0.540f, 0.515f, 0.470f}, {0.180f, 0.165f, 0.150f}, 0.001f, 0.018f, 0.75f}, // birch
    {{0.160f, 0.120f, 0.085f}, {0.200f, 0.180f, 0.150f}, {0.185f, 0.165f, 0.140f}, 0.004f, 0.009f, 0.95f}, // maple
    {{0.250f, 0.225f, 0.080f}, {0.190f, 0.170f, 0.120f}, {0.155f, 0.132f, 0.102f}, 0.010f, 0.028f, 0.95f}, // willow
    {{0.165f, 0.135f, 0.090f}, {0.400f, 0.395f, 0.305f}, {0.150f, 0.142f, 0.118f}, 0.002f, 0.018f, 0.85f}, // aspen
    {{0.230f, 0.155f, 0.090f}, {0.340f, 0.180f, 0.085f}, {0.185f, 0.135f, 0.105f}, 0.002f, 0.022f, 0.90f}, // pine
    {{0.210f, 0.130f, 0.072f}, {0.165f, 0.120f, 0.090f}, {0.150f, 0.120f, 0.100f}, 0.002f, 0.005f, 0.95f}, // spruce
    {{0.120f, 0.105f, 0.060f}, {0.195f, 0.140f, 0.105f}, {0.190f, 0.155f, 0.125f}, 0.002f, 0.006f, 0.95f}, // cypress
    {{0.130f, 0.082f, 0.062f}, {0.150f, 0.092f, 0.070f}, {0.140f, 0.100f, 0.080f}, 0.002f, 0.004f, 0.50f}, // cherry
}};

glm::dvec3 mean_of(const Image& image) {
    glm::dvec3 sum(0.0);
    for (std::size_t i = 0; i < image.pixels.size(); ++i)
        sum[i % 3] += double(image.pixels[i]);
    return sum * 3.0 / double(image.pixels.size());
}

/// Scales the channels; what would pass 1 stays at 1.
void scale(Image& image, const glm::dvec3& factor) {
    for (std::size_t i = 0; i < image.pixels.size(); ++i)
        image.pixels[i] = std::min(1.f, float(double(image.pixels[i]) * factor[i % 3]));
}

/// Colour and height as the pattern gives them.
void draw(BarkKind kind, float age, Image& color, Image& height) {
    const BarkPattern pattern(kind, age);
    const int size = color.width;
    parallel_blocks(std::size_t(size), 16, [&](std::size_t begin, std::size_t end) {
        for (std::size_t y = begin; y < end; ++y)
            for (int x = 0; x < size; ++x) {
                const BarkPattern::Point point =
                    pattern.at({(float(x) + 0.5f) / float(size), (float(y) + 0.5f) / float(size)});
                for (std::size_t c = 0; c < 3; ++c)
                    color.at(x, int(y))[c] = std::max(0.01f, point.color[c]);
                height.at(x, int(y))[0] = point.height;
            }
    });
}

/// What the pattern's colours are scaled by at an age.
glm::dvec3 color_scale(BarkKind kind, float age, const Image& drawn) {
    const BarkMeasures& m = measures.at(std::size_t(kind));
    if (!turns_with_age(kind))
        return glm::dvec3(glm::mix(m.young, m.old, age)) / mean_of(drawn);
    Image young(64, 64, 3), height(64, 64, 1);
    draw(kind, 0, young, height);
    return glm::dvec3(m.young) / mean_of(young);
}

/// Stretches heights to 0..1; even ones become 0.5.
void set_range(Image& height) {
    const auto [low, high] = std::minmax_element(height.pixels.begin(), height.pixels.end());
    const float from = *low, range = *high - *low;
    for (float& value : height.pixels)
        value = range > 1e-6f ? std::clamp((value - from) / range, 0.f, 1.f) : 0.5f;
}

} // namespace

bool turns_with_age(BarkKind kind) {
    return kind == BarkKind::birch || kind == BarkKind::aspen || kind == BarkKind::pine;
}

glm::vec3 young_twig_color(BarkKind kind) {
    return measures.at(std::size_t(kind)).twig;
}

float bark_roughness(BarkKind kind) {
    return measures.at(std::size_t(kind)).roughness;
}

glm::vec3 mean_bark_color(BarkKind kind, float age) {
    const BarkMeasures& m = measures.at(std::size_t(kind));
    if (!turns_with_age(kind))
        return glm::mix(m.young, m.old, age);
    return glm::vec3(mean_of(bark_image(kind, age, 64).color));
}

BarkImage bark_image(BarkKind kind, float age, int size) {
    if (size < 1 || size > 8192 || !(age >= 0 && age <= 1))
        throw std::invalid_argument("bark_image: size must be 1 to 8192 and age 0 to 1");
    const BarkMeasures& m = measures.at(std::size_t(kind));
    BarkImage bark{Image(size, size, 3), Image(size, size, 1), glm::mix(m.young_depth_m, m.old_depth_m, age),
                   m.roughness};
    draw(kind, age, bark.color, bark.height);
    scale(bark.color, color_scale(kind, age, bark.color));
    set_range(bark.height);
    return bark;
}

} // namespace kokage
