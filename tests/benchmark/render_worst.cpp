#include "tests/benchmark/render_worst.h"
#include "tests/benchmark/markdown.h"

#include <algorithm>
#include <cmath>

namespace kokage {
namespace {

using Figures = std::map<std::string, double>;

std::string percent(double value) {
    return three_digits(value, 100) + " %";
}

std::string signed_percent(double value) {
    return (value > 0 ? "+" : value < 0 ? "−" : "") + percent(std::abs(value));
}

/// The names in the order of falling size.
std::vector<std::string> by_size(const Figures& figures) {
    std::vector<std::string> names;
    for (const auto& [name, value] : figures)
        names.push_back(name);
    std::stable_sort(names.begin(), names.end(), [&](const std::string& a, const std::string& b) {
        return std::abs(figures.at(a)) > std::abs(figures.at(b));
    });
    return names;
}

/// Of the squared error, what stays with any number of samples.
double systematic_share(const PictureRecord& r, const std::string& kind) {
    const double stays = r.systematic_error_of.at(kind), goes = r.sampling_error_of.at(kind);
    return stays * stays + goes * goes > 0 ? stays * stays / (stays * stays + goes * goes) : 0;
}

std::string kind_text(const PictureRecord& r, const std::string& kind) {
    std::string text = kind + " " + percent(r.mean_error_of.at(kind)) + " on " + percent(r.share_of.at(kind)) +
                       " of the pixels (bias " + signed_percent(r.bias_of.at(kind)) + "; systematic " +
                       percent(systematic_share(r, kind)) + " of the squared error";
    if (const auto lights = r.bias_by_light.find(kind); lights != r.bias_by_light.end() && !lights->second.empty()) {
        const std::string largest = by_size(lights->second).front();
        text += "; of the bias " + signed_percent(lights->second.at(largest)) + " in " + largest + " light";
    }
    return text + ")";
}

std::string paragraph(const PictureRecord& r) {
    Figures parts; // of the mean error
    for (const auto& [kind, error] : r.mean_error_of)
        parts[kind] = error * r.share_of.at(kind) / *r.mean_error;
    const std::string worst = by_size(r.mean_error_of).front(), most = by_size(parts).front();
    std::string text = "**" + r.scene + "**, " + r.effort + ": the largest error is that of " + worst + "; " +
                       (most == worst ? "it" : most) + " makes up " + percent(parts.at(most)) +
                       " of the picture's. By kind: ";
    bool first = true;
    for (const std::string& kind : by_size(r.mean_error_of)) {
        text += (first ? "" : "; ") + kind_text(r, kind);
        first = false;
    }
    return text + ".\n\n";
}

} // namespace

std::string worst_text(const std::vector<PictureRecord>& records) {
    std::map<std::string, const PictureRecord*> of_scene;
    for (const PictureRecord& r : records)
        if (!r.systematic_error_of.empty() && r.mean_error && *r.mean_error > 0)
            of_scene[r.scene] = &r;
    std::string text;
    for (const auto& [scene, record] : of_scene)
        text += paragraph(*record);
    return text;
}

} // namespace kokage
