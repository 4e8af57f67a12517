#include "tests/benchmark/reflection_environments.h"
#include "common/environment/load_environment.h"

#include <algorithm>
#include <cmath>

namespace kokage {

namespace {

constexpr int kWidth = 512, kHeight = 256;

/// HSL with lightness 0.5: chroma is the saturation, and the colours lie symmetrically around 0.5.
glm::vec3 colour_of_hue(double hue, double saturation) {
    const auto channel = [&](double offset) {
        const double place = std::fmod(hue * 6 + offset, 6.0);
        const double ramp = std::clamp(std::abs(place - 3) - 1, 0.0, 1.0); // 1 at red, 0 opposite
        return float(0.5 + saturation * (ramp - 0.5));
    };
    return {channel(0), channel(4), channel(2)};
}

} // namespace

Image colour_pattern() {
    Image image(kWidth, kHeight, 3);
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            const glm::vec3 colour = colour_of_hue(double(x) / kWidth, double(y) / (kHeight - 1));
            for (int c = 0; c < 3; ++c)
                image.at(x, y)[c] = colour[glm::length_t(c)];
        }
    return image;
}

Image photograph(const std::filesystem::path& data_folder) {
    const Image full = real_hdr(data_folder, "overcast_potsdamer_platz.hdr", 0);
    Image image(full.width / 2, full.height / 2, 3);
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            for (int c = 0; c < 3; ++c) {
                const float sum = full.at(2 * x, 2 * y)[c] + full.at(2 * x + 1, 2 * y)[c] +
                                  full.at(2 * x, 2 * y + 1)[c] + full.at(2 * x + 1, 2 * y + 1)[c];
                image.at(x, y)[c] = std::clamp(sum / 4, 0.f, 1.f);
            }
    return image;
}

Image lone_sun() {
    Image image(kWidth, kHeight, 3);
    std::fill(image.pixels.begin(), image.pixels.end(), 0.1f);
    for (int c = 0; c < 3; ++c)
        image.at(180, 78)[c] = 1e6f;
    return image;
}

const std::vector<std::string>& real_hdr_files() {
    static const std::vector<std::string> files = {"sky_clouds_sun.hdr", "interior_hotel.exr", "night_dikhololo.hdr"};
    return files;
}

Image real_hdr(const std::filesystem::path& data_folder, const std::string& file, int width) {
    EnvironmentReport report;
    EnvironmentLoading loading;
    loading.split = false;
    loading.max_width = 0;
    Image image = load_environment(data_folder / "env" / file, report, loading).remainder;
    return width > 0 ? reduce_lat_long(std::move(image), width) : image;
}

Environment unsplit(Image image, std::string description) {
    Environment environment;
    environment.remainder = std::move(image);
    environment.description = std::move(description);
    return environment;
}

} // namespace kokage
