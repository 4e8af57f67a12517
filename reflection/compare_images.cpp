#include "reflection/compare_images.h"
#include "common/services/error.h"
#include "common/types.h"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace kokage {
namespace {

/// Polynomial fit of matplotlib's `inferno` (Matt Zucker, shadertoy WlfXRN, CC0): within 0.01 of the table.
glm::vec3 inferno(float t) {
    t = std::clamp(t, 0.f, 1.f);
    const glm::vec3 c0(0.0002189403691192265f, 0.001651004631001012f, -0.01948089843709184f);
    const glm::vec3 c1(0.1065134194856116f, 0.5639564367884091f, 3.932712388889277f);
    const glm::vec3 c2(11.60249308247187f, -3.972853965665698f, -15.9423941062914f);
    const glm::vec3 c3(-41.70399613139459f, 17.43639888205313f, 44.35414519872813f);
    const glm::vec3 c4(77.162935699427f, -33.40235894210092f, -81.80730925738993f);
    const glm::vec3 c5(-71.31942824499214f, 32.62606426397723f, 73.20951985803202f);
    const glm::vec3 c6(25.13112622477341f, -12.24266895238567f, -23.07032500287172f);
    return glm::clamp(c0 + t * (c1 + t * (c2 + t * (c3 + t * (c4 + t * (c5 + t * c6))))), 0.f, 1.f);
}

const glm::vec3 kNotFiniteColor(0.f, 1.f, 0.f);

void set_pixel(Image& image, int x, int y, const glm::vec3& color) {
    for (int c = 0; c < 3; ++c)
        image.at(x, y)[c] = color[std::size_t(c)];
}

/// The value that `share` of the values don't exceed. Reorders.
double percentile(std::vector<float>& values, double share) {
    if (values.empty())
        return 0;
    const auto rank =
        std::min(values.size() - 1, std::size_t(std::ceil(share * double(values.size()))) - (share > 0 ? 1 : 0));
    std::nth_element(values.begin(), values.begin() + std::ptrdiff_t(rank), values.end());
    return double(values[rank]);
}

struct Pair {
    float a, b;
};

DifferenceFigures figures(const std::vector<Pair>& pairs) {
    DifferenceFigures result;
    if (pairs.empty())
        return result;
    double reference = 0;
    for (const Pair& pair : pairs)
        reference += std::abs(double(pair.b));
    const auto count = double(pairs.size());
    const double floor = 0.05 * reference / count;
    std::vector<float> sizes;
    sizes.reserve(pairs.size());
    double squares = 0;
    if (floor > 0)
        result.relative = 0;
    for (const Pair& pair : pairs) {
        const double d = double(pair.a) - double(pair.b), size = std::abs(d);
        result.mean += size / count;
        squares += d * d / count;
        result.bias += d / count;
        result.max = std::max(result.max, size);
        if (result.relative)
            *result.relative += size / std::max(std::abs(double(pair.b)), floor) / count;
        sizes.push_back(float(size));
    }
    result.rms = std::sqrt(squares);
    result.p95 = percentile(sizes, 0.95);
    return result;
}

void check(const Image& a, const Image& b) {
    auto shape = [](const Image& image) {
        return std::to_string(image.width) + " x " + std::to_string(image.height) + " with " +
               std::to_string(image.channels) + " channels";
    };
    if (a.width != b.width || a.height != b.height || a.channels != b.channels)
        throw InputError("compare: the first picture is " + shape(a) + ", the second " + shape(b) +
                         "; give two of the same shape");
    if (a.empty() || a.channels > 4)
        throw InputError("compare: the pictures are " + shape(a) + "; give pictures with pixels and 1 to 4 channels");
}

} // namespace

ImageComparison compare_images(const Image& a, const Image& b) {
    check(a, b);
    ImageComparison result;
    result.channels = a.channels;
    std::vector<Pair> all;
    std::array<std::vector<Pair>, 4> channels;
    std::vector<float> largest(std::size_t(a.width) * std::size_t(a.height), 0.f); // of a pixel; -1 = not finite
    double max = -1;
    for (int y = 0; y < a.height; ++y)
        for (int x = 0; x < a.width; ++x) {
            float& size = largest[std::size_t(y) * std::size_t(a.width) + std::size_t(x)];
            bool whole = true;
            for (int c = 0; c < a.channels; ++c) {
                const Pair pair{a.at(x, y)[c], b.at(x, y)[c]};
                if (!std::isfinite(pair.a) || !std::isfinite(pair.b)) {
                    ++result.skipped_values;
                    whole = false;
                    continue;
                }
                channels[std::size_t(c)].push_back(pair);
                all.push_back(pair);
                const double d = std::abs(double(pair.a) - double(pair.b));
                size = std::max(size, float(std::min(d, 3e38)));
                if (d > max) {
                    max = d;
                    result.max_x = x;
                    result.max_y = y;
                }
            }
            if (!whole)
                size = -1;
        }
    result.all = figures(all);
    for (int c = 0; c < a.channels; ++c)
        result.per_channel[std::size_t(c)] = figures(channels[std::size_t(c)]);

    std::vector<float> finite_sizes;
    std::copy_if(largest.begin(), largest.end(), std::back_inserter(finite_sizes),
                 [](float size) { return size >= 0; });
    result.map_scale = float(percentile(finite_sizes, 0.99));
    if (result.map_scale == 0)
        result.map_scale = float(std::min(result.all.max, 3e38));
    result.map = Image(a.width, a.height, 3);
    for (int y = 0; y < a.height; ++y)
        for (int x = 0; x < a.width; ++x) {
            const float size = largest[std::size_t(y) * std::size_t(a.width) + std::size_t(x)];
            set_pixel(result.map, x, y,
                      size < 0 ? kNotFiniteColor : inferno(result.map_scale > 0 ? size / result.map_scale : 0.f));
        }
    return result;
}

Image error_legend(int width, int height) {
    Image legend(width, height, 3);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            set_pixel(legend, x, y, inferno(width > 1 ? float(x) / float(width - 1) : 0.f));
    return legend;
}

std::string error_legend_text(double scale, double unit, const std::string& suffix) {
    if (scale == 0)
        return "all black: no difference";
    std::ostringstream text;
    text.precision(3);
    text << "black 0";
    const char* names[] = {"violet", "red-purple", "orange", "pale yellow"};
    for (int i = 0; i < 4; ++i)
        text << ", " << names[i] << ' ' << scale * unit * (i + 1) / 4 << suffix;
    text << " and above";
    return text.str();
}

std::string describe(const ImageComparison& comparison) {
    std::ostringstream line;
    line.precision(4);
    const DifferenceFigures& f = comparison.all;
    line << "mean " << f.mean << ", rms " << f.rms << ", 95 % below " << f.p95 << ", max " << f.max << " at pixel ("
         << comparison.max_x << ", " << comparison.max_y << "), bias " << f.bias << ", relative ";
    if (f.relative)
        line << 100 * *f.relative << " %";
    else
        line << "undefined (the reference is black)";
    if (comparison.skipped_values > 0)
        line << "; " << comparison.skipped_values << " values are not finite and not counted";
    return line.str();
}

} // namespace kokage
