// Pixels near a direction, summed by vectors, against plain loops in double.
#include "common/directions/lobes.h"
#include "common/environment/lat_long.h"
#include "common/services/random.h"
#include "reflection/maps/brute_force_baker.h"
#include "reflection/maps/near_sums.h"

#include <cmath>
#include <gtest/gtest.h>

using namespace kokage;

namespace {

Image noise_to_sum(int width, int height) {
    Image image(width, height, 3);
    Random random(4);
    for (float& value : image.pixels)
        value = random.uniform();
    return image;
}

/// The poles, both sides of the image's border, pixel centres, and anywhere.
std::vector<glm::dvec3> directions(int width, int height) {
    std::vector<glm::dvec3> all{{0, 1, 0},      {0, -1, 0},      {-1, 0, 0},
                                {-1, 0, -1e-9}, {1e-4, 1, 1e-5}, pixel_direction(0, 0, width, height),
                                {1, 0, 0},      {-1, 2, -1e-3},  pixel_direction(width - 1, height / 2, width, height)};
    Random random(8);
    for (int i = 0; i < 30; ++i)
        all.emplace_back(random.uniform_double() - 0.5, random.uniform_double() - 0.5, random.uniform_double() - 0.5);
    for (glm::dvec3& direction : all)
        direction = glm::normalize(direction);
    return all;
}

TEST(NearSums, ThePartIsTheSlowSum) {
    for (const glm::ivec2 size : {glm::ivec2(256, 128), {97, 31}, {40, 90}, {5, 3}, {1, 1}}) {
        const Image image = noise_to_sum(size.x, size.y);
        NearSums pixels(size.x, size.y);
        pixels.set_pixels(image, 0.5f);
        NearSums::Scratch scratch;
        for (const double roughness : {0.01, 0.05, 0.15})
            for (const double sharpest : {30.0, 3000.0}) {
                const NearLobe near{{LobeKind::ggx, roughness}, sharpest, std::min(1.0, 40 / sharpest)};
                const double u = 1 / ggx_falloff(roughness);
                for (const glm::dvec3& direction : directions(size.x, size.y)) {
                    glm::dvec4 slow(0);
                    for (int y = 0; y < size.y; ++y)
                        for (int x = 0; x < size.x; ++x) {
                            const glm::dvec3 between = pixel_direction(x, y, size.x, size.y) - direction;
                            const double squared = glm::dot(between, between), b = sharpest * (u + 0.5 * squared);
                            const double weight = pixel_solid_angle(y, size.x, size.y) * (1 + b) * std::exp(-b) *
                                                  lobe_value(near.lobe, squared) / lobe_value(near.lobe, 0);
                            const float* p = image.at(x, y);
                            slow += weight * glm::dvec4(0.5 * double(p[0]), 0.5 * double(p[1]), 0.5 * double(p[2]), 1);
                        }
                    const glm::dvec4 fast = pixels.part(near, direction, scratch);
                    // Where the nearest pixel is far beyond the peak, what is summed is far below a pixel in the peak.
                    const double floor = 1e-12 * pixel_solid_angle(0, size.x, size.y) * u * u;
                    for (glm::length_t c = 0; c < 4; ++c)
                        ASSERT_NEAR(fast[c], slow[c], 2e-5 * slow[c] + floor)
                            << size.x << "x" << size.y << " roughness " << roughness << " sharpest " << sharpest;
                }
            }
    }
}

TEST(NearSums, TheWholeLobeIsTheBruteForce) {
    for (const glm::ivec2 size : {glm::ivec2(128, 64), {97, 31}, {40, 90}, {3, 5}, {1, 1}}) {
        Environment environment;
        environment.remainder = noise_to_sum(size.x, size.y);
        NearSums pixels(size.x, size.y);
        pixels.set_pixels(environment.remainder);
        NearSums::Scratch scratch;
        for (const Lobe& lobe : {Lobe{LobeKind::phong, 1}, Lobe{LobeKind::phong, 300}, Lobe{LobeKind::phong, 3e4},
                                 Lobe{LobeKind::phong, 1e7}, Lobe{LobeKind::ggx, 0.01}, Lobe{LobeKind::ggx, 0.2}}) {
            const double reach = lobe.kind == LobeKind::ggx ? 1 : 0.5 * lobe_reach(lobe, 1e-13);
            if (lobe.parameter > 1e6 && size.y < 30)
                continue; // pixels as far away but for the last digits: either is right
            for (const glm::dvec3& direction : directions(size.x, size.y)) {
                const glm::vec3 fast = pixels.whole({lobe, 0, reach}, direction, scratch);
                const glm::dvec3 slow = filtered_by_brute_force(environment, lobe, direction);
                for (glm::length_t c = 0; c < 3; ++c)
                    ASSERT_NEAR(double(fast[c]), slow[c], lobe.parameter > 1e4 ? 1e-3 : 1e-5)
                        << size.x << "x" << size.y << " " << lobe_kind_name(lobe.kind) << " " << lobe.parameter
                        << " towards " << direction.x << " " << direction.y << " " << direction.z;
            }
        }
    }
}

} // namespace
