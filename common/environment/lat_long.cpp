#include "common/environment/lat_long.h"
#include "common/services/parallel.h"

#include <algorithm>
#include <cmath>

namespace kokage {

glm::vec2 lat_long_from_direction(const glm::vec3& direction) {
    float u = 0.5f + std::atan2(direction.z, direction.x) / (2 * kPi);
    u -= std::floor(u);
    return {u < 1.f ? u : 0.f, std::acos(std::clamp(direction.y, -1.f, 1.f)) / kPi};
}

glm::vec3 direction_from_lat_long(glm::vec2 uv) {
    const float azimuth = (uv.x - 0.5f) * 2 * kPi, polar = uv.y * kPi;
    const float sine = std::sin(polar);
    return {sine * std::cos(azimuth), std::cos(polar), sine * std::sin(azimuth)};
}

glm::dvec3 pixel_direction(int x, int y, int width, int height) {
    const double azimuth = ((x + 0.5) / width - 0.5) * 2 * kPiDouble, polar = (y + 0.5) / height * kPiDouble;
    return {std::sin(polar) * std::cos(azimuth), std::cos(polar), std::sin(polar) * std::sin(azimuth)};
}

double pixel_solid_angle(int y, int width, int height) {
    // cos a - cos b = 2 sin((a+b)/2) sin((b-a)/2): no cancellation at the poles of tall images.
    const double step = kPiDouble / height;
    return 2 * kPiDouble / width * 2 * std::sin((y + 0.5) * step) * std::sin(0.5 * step);
}

glm::vec3 lat_long_radiance(const Image& image, const glm::vec3& direction) {
    const glm::vec2 uv = lat_long_from_direction(direction);
    const float x = uv.x * float(image.width) - 0.5f, y = uv.y * float(image.height) - 0.5f;
    const float fx = x - std::floor(x), fy = y - std::floor(y);
    const int x0 = (int(std::floor(x)) + image.width) % image.width, x1 = (x0 + 1) % image.width;
    const int y0 = std::clamp(int(std::floor(y)), 0, image.height - 1);
    const int y1 = std::clamp(int(std::floor(y)) + 1, 0, image.height - 1);
    auto pixel = [&](int px, int py) {
        return glm::vec3(image.at(px, py)[0], image.at(px, py)[1], image.at(px, py)[2]);
    };
    return (1 - fy) * ((1 - fx) * pixel(x0, y0) + fx * pixel(x1, y0)) +
           fy * ((1 - fx) * pixel(x0, y1) + fx * pixel(x1, y1));
}

namespace {

/// Which old cells a new cell covers, and how much of each.
struct Overlap {
    int first;
    std::vector<double> weights; ///< sum 1
};

/// Cells between consecutive borders (ascending); measured by `measure(border)`.
template <typename Measure>
std::vector<Overlap> overlaps(int old_count, int new_count, Measure measure) {
    std::vector<Overlap> result;
    for (int i = 0; i < new_count; ++i) {
        const double begin = double(i) * old_count / new_count, end = double(i + 1) * old_count / new_count;
        Overlap overlap{int(begin), {}};
        const double size = measure(end) - measure(begin);
        for (int cell = overlap.first; cell < old_count && cell < end; ++cell)
            overlap.weights.push_back((measure(std::min(end, cell + 1.0)) - measure(std::max(begin, double(cell)))) /
                                      size);
        result.push_back(std::move(overlap));
    }
    return result;
}

} // namespace

Image reduce_lat_long(Image image, int width) {
    if (width < 1 || image.width <= width)
        return image;
    const int height = std::max(1, int(std::lround(double(image.height) * width / image.width)));
    const auto columns = overlaps(image.width, width, [](double x) { return x; });
    // 1 - cos(theta), written so that rows at the poles keep their digits.
    const auto rows = overlaps(image.height, height, [&](double y) {
        const double sine = std::sin(0.5 * kPiDouble * y / image.height);
        return 2 * sine * sine;
    });
    Image result(width, height, image.channels);
    parallel_blocks(std::size_t(height), 8, [&](std::size_t begin, std::size_t end) {
        std::vector<double> sum(std::size_t(image.channels));
        for (std::size_t y = begin; y < end; ++y)
            for (int x = 0; x < width; ++x) {
                std::fill(sum.begin(), sum.end(), 0.0);
                const Overlap &row = rows[y], &column = columns[std::size_t(x)];
                for (std::size_t j = 0; j < row.weights.size(); ++j)
                    for (std::size_t i = 0; i < column.weights.size(); ++i) {
                        const float* pixel = image.at(column.first + int(i), row.first + int(j));
                        for (std::size_t c = 0; c < sum.size(); ++c)
                            sum[c] += row.weights[j] * column.weights[i] * double(pixel[c]);
                    }
                for (std::size_t c = 0; c < sum.size(); ++c)
                    result.at(x, int(y))[c] = float(sum[c]);
            }
    });
    return result;
}

Image with_square_pixels(Image image) {
    const int times = image.empty() ? 1 : (2 * image.height + image.width - 1) / image.width;
    if (times <= 1)
        return image;
    Image divided(image.width * times, image.height, image.channels);
    for (int y = 0; y < divided.height; ++y)
        for (int x = 0; x < divided.width; ++x)
            std::copy_n(image.at(x / times, y), image.channels, divided.at(x, y));
    return divided;
}

} // namespace kokage
