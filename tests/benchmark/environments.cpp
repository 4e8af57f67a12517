#include "tests/benchmark/environments.h"
#include "common/environment/analytic_sky.h"
#include "common/environment/load_environment.h"
#include "common/services/random.h"

#include <cmath>
#include <string>

namespace kokage {

namespace {

// Written out although some are defaults: a stored reference belongs to these values.
Environment daylight() {
    Daylight settings;
    settings.sun_azimuth_degrees = 135;
    settings.sun_elevation_degrees = 55;
    settings.turbidity = 2.5;
    settings.width = 256;
    return analytic_sky(settings);
}

Environment hotel_room(const std::filesystem::path& data_folder) {
    EnvironmentLoading loading;
    loading.max_width = 4096;
    loading.splitting.brightness_ratio = 8;
    loading.splitting.gap_degrees = 1.5;
    loading.splitting.least_share = 0.005;
    loading.splitting.max_lights = 64;
    loading.splitting.max_texels = 64;
    EnvironmentReport report;
    Environment environment = load_environment(lamp_lit_file(data_folder), report, loading);
    environment.description = "interior_hotel.exr"; // without the folder, which is the user's own business
    return environment;
}

/// The CIE standard overcast sky, L = L_zenith (1 + 2 sin elevation) / 3, bluish; black below the horizon.
Image overcast_sky(float zenith_radiance) {
    Image image(64, 64, 3);
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            const glm::vec3 direction = direction_from_lat_long(
                {(float(x) + 0.5f) / float(image.width), (float(y) + 0.5f) / float(image.height)});
            const float radiance = direction.y > 0 ? zenith_radiance * (1 + 2 * direction.y) / 3 : 0.f;
            const glm::vec3 tint(0.9f, 1.f, 1.15f);
            for (int c = 0; c < 3; ++c)
                image.at(x, y)[c] = radiance * tint[glm::length_t(c)];
        }
    return image;
}

/// A dim grey sky over a ground, which lights are added to.
Environment dim_sky(std::string description) {
    Environment environment = constant_environment(glm::vec3(0.15f));
    environment.description = std::move(description);
    return environment;
}

/// Lights spread evenly over the upper hemisphere (a Fibonacci spiral), each a disc of half a degree, irradiances
/// between 0.5 and 1.5 of their mean, 3 in sum.
Environment sky_with_lights(int count) {
    Environment environment = dim_sky(std::to_string(count) + " lights under a dim grey sky");
    float sum = 0;
    for (int i = 0; i < count; ++i) {
        const float height = count == 1 ? 0.8f : 0.15f + 0.8f * (float(i) + 0.5f) / float(count);
        const float angle = 2.39996323f * float(i), radius = std::sqrt(1 - height * height);
        DistantLight light;
        light.name = "light " + std::to_string(i + 1) + " of " + std::to_string(count);
        light.direction = glm::normalize(glm::vec3(radius * std::cos(angle), height, radius * std::sin(angle)));
        light.half_angle = 0.5f * kPi / 180.f;
        const float share = 0.5f + Random(9, std::uint64_t(i)).uniform();
        light.irradiance = glm::vec3(share);
        sum += share;
        environment.distant_lights.push_back(light);
    }
    for (DistantLight& light : environment.distant_lights)
        light.irradiance *= 3.f / sum;
    return environment;
}

Environment sky_with_point_light() {
    Environment environment = dim_sky("a point light 0.9 m from the crown under a dim grey sky");
    // The crown ends about 4.4 m from the trunk; irradiance at its nearest leaves is about 20, at its far side 0.2.
    environment.point_lights.push_back({"lamp", {5.2f, 5.5f, 1.f}, glm::vec3(16.f, 13.f, 9.f)});
    return environment;
}

} // namespace

std::filesystem::path lamp_lit_file(const std::filesystem::path& data_folder) {
    return data_folder / "env" / "interior_hotel.exr";
}

Environment make_bench_environment(BenchLight light, const std::filesystem::path& data_folder) {
    switch (light) {
    case BenchLight::sky_sun:
        return daylight();
    case BenchLight::sky_sun_relit: {
        Environment environment = daylight();
        environment.remainder = overcast_sky(0.8f);
        environment.description = "CIE overcast sky with the sun of the analytic sky";
        return environment;
    }
    case BenchLight::lamp_lit:
        return hotel_room(data_folder);
    case BenchLight::one_light:
        return sky_with_lights(1);
    case BenchLight::many_lights:
        return sky_with_lights(64);
    case BenchLight::point_light:
        return sky_with_point_light();
    case BenchLight::furnace:
        return constant_environment(glm::vec3(1.f));
    }
    return {};
}

Environment with_another_sky(const Environment& environment) {
    Environment other = environment;
    const Image& from = environment.remainder;
    const glm::vec3 tint(1.2f, 1.f, 0.8f);
    for (int y = 0; y < from.height; ++y)
        for (int x = 0; x < from.width; ++x)
            for (int c = 0; c < 3; ++c)
                other.remainder.at(x, y)[c] = tint[glm::length_t(c)] * from.at((x + from.width / 4) % from.width, y)[c];
    other.description += ", its sky turned and tinted";
    return other;
}

} // namespace kokage
