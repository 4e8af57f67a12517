#include "common/services/error.h"
#include "reflection/picture.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>

namespace kokage {
namespace {

constexpr float kMiddleGrey = 0.18f;
constexpr float kCompensation =
    1.2f; ///< a crown is darker than a grey card: photographers open a quarter of a stop for it
constexpr double kSubjectShare = 0.5; ///< of the metering that what is shown has at least, however slender it is
constexpr float kBrightShare = 0.93f; ///< of the metered picture that must stay below …
constexpr float kHighlight = 1.1f;    ///< … what the curve shows as a light grey of 0.93
constexpr double kYield =
    0.35; ///< against the light, what is bright gives way by this share, so that the rest is no silhouette
constexpr double kLift =
    0.5; ///< where a slender subject leaves room below the highlight, so much of it is used: skies shine
constexpr double kDeepStops = 4.5; ///< what is so much darker than that is background or deep shade: not metered
constexpr float kLeast = 1e-30f, kMost = 1e30f;

void check_channels(const Image& image) {
    if (image.channels < 3 && !image.empty())
        throw InputError("tone mapping: the picture has " + std::to_string(image.channels) + " channels; it needs 3");
}

float finite(float value) {
    return value > 0 ? std::min(value, kMost) : 0.f;
} // NaN compares false

/// Uchimura, "HDR theory and practice" (CEDEC 2017), slides 112-116, with his defaults: a toe of power c, a straight
/// middle of slope a from m on for the length l, and an exponential shoulder that ends at P.
float filmic(float x) {
    constexpr float P = 1, a = 1, m = 0.22f, l = 0.4f, c = 1.33f, b = 0;
    constexpr float l0 = (P - m) * l / a, S0 = m + l0, S1 = m + a * l0, C2 = a * P / (P - S1);
    if (x >= S0)
        return P - (P - S1) * std::exp(-C2 * (x - S0) / P);
    const float straight = m + a * (x - m);
    if (x >= m)
        return straight;
    const float t = x / m, share = t * t * (3 - 2 * t);
    return (1 - share) * (m * std::pow(t, c) + b) + share * straight;
}

float srgb(float linear) {
    return linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1 / 2.4f) - 0.055f;
}

struct Metered {
    float luminance;
    float weight;  ///< of its place in the picture
    float subject; ///< share of the pixel that shows the subject
};

/// By how much pixels of the subject count more than their place in the picture says.
double subject_gain(const std::vector<Metered>& lit) {
    double total = 0, subject = 0;
    for (const Metered& pixel : lit) {
        total += double(pixel.weight);
        subject += double(pixel.weight * pixel.subject);
    }
    if (!(subject > 1e-4 * total) || subject >= kSubjectShare * total)
        return 1;
    return kSubjectShare / (1 - kSubjectShare) * (total - subject) / subject;
}

} // namespace

float automatic_exposure_stops(const Image& radiance, const Image* subject) {
    check_channels(radiance);
    if (subject && (subject->width != radiance.width || subject->height != radiance.height))
        throw InputError("exposure: the picture and the mask of its subject differ in size");
    std::vector<Metered> lit;
    double total = 0;
    for (int y = 0; y < radiance.height; ++y)
        for (int x = 0; x < radiance.width; ++x) {
            const float* pixel = radiance.at(x, y);
            const float value = luminance({finite(pixel[0]), finite(pixel[1]), finite(pixel[2])});
            if (value <= kLeast)
                continue; // black surroundings are no reason to overexpose what is there
            const float dx = 2 * (float(x) + 0.5f) / float(radiance.width) - 1,
                        dy = 2 * (float(y) + 0.5f) / float(radiance.height) - 1;
            const float weight = 0.15f + std::exp(-2.5f * (dx * dx + dy * dy));
            lit.push_back({value, weight, subject ? subject->at(x, y)[0] : 0.f});
            total += double(weight);
        }
    if (lit.empty())
        return 0;
    std::sort(lit.begin(), lit.end(), [](const Metered& a, const Metered& b) {
        return std::tie(a.luminance, a.weight, a.subject) < std::tie(b.luminance, b.weight, b.subject);
    });
    double passed = 0;
    const auto bright_pixel = std::find_if(lit.begin(), lit.end(), [&](const Metered& pixel) {
        passed += double(pixel.weight);
        return passed >= double(kBrightShare) * total;
    });
    const double bright = std::log2(double((bright_pixel == lit.end() ? lit.back() : *bright_pixel).luminance));
    const double gain = subject_gain(lit);
    double sum = 0, counted = 0;
    for (const Metered& pixel : lit) {
        const double stops = std::log2(double(pixel.luminance));
        if (stops < bright - kDeepStops || stops > bright)
            continue;
        const double weight = double(pixel.weight) * (1 + (gain - 1) * double(pixel.subject));
        sum += weight * stops;
        counted += weight;
    }
    const double for_mean = std::log2(double(kMiddleGrey * kCompensation)) - sum / counted;
    const double for_bright = std::log2(double(kHighlight)) - bright;
    if (for_mean <= for_bright) // a pale bare tree would leave the sky dull
        return float(gain > 1 ? for_mean + kLift * (for_bright - for_mean) : for_mean);
    return float(for_bright + kYield * (for_mean - for_bright));
}

Image tone_map(const Image& radiance, std::optional<float> exposure_stops, const Image* subject) {
    check_channels(radiance);
    const float stops = exposure_stops ? *exposure_stops : automatic_exposure_stops(radiance, subject);
    if (!std::isfinite(stops))
        throw InputError("exposure " + std::to_string(stops) + " stops: give a finite number, or none for automatic");
    // In double: the dimmest radiance at the highest exposure still has a product.
    const double scale = std::exp2(std::clamp(double(stops), -200.0, 200.0));
    Image display(radiance.width, radiance.height, 3);
    for (int y = 0; y < radiance.height; ++y)
        for (int x = 0; x < radiance.width; ++x)
            for (int c = 0; c < 3; ++c) {
                const auto exposed = float(std::min(scale * double(finite(radiance.at(x, y)[c])), 1e6));
                display.at(x, y)[c] = std::clamp(srgb(filmic(exposed)), 0.f, 1.f);
            }
    return display;
}

} // namespace kokage
